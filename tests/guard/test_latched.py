"""A latched goal is acted on once, whoever guards."""

import pytest
from streams import peer, stage, stream

from rtron.guard.host import Host
from rtron.guard.transport.memory import MemoryTransport
from rtron.guard.will import Will
from rtron.vocabulary import PolicyName, StreamKind

IN, OUT = "/rtron/goal/flow1", "/rtron/goal/out"


def guard(left=b"", kind=StreamKind.ACTION, *, dry_run=False):
    written = []
    made = stream(stage(policy=PolicyName.BLOCK, kind=kind), topic="/goal")
    transport = MemoryTransport()
    Host(transport, [made], will=Will(left, written.append), dry_run=dry_run).open()
    return transport, transport.listen(OUT), written


def connect(transport, node="/nav", *, latching=True):
    return transport.publisher(IN, peer(node, latching=latching))


def test_the_next_guard_does_not_act_on_it_again():
    transport, out, written = guard()
    connect(transport)(b"kitchen")
    assert out == [b"kitchen"]
    transport, out, _ = guard(written[-1])
    say = connect(transport)
    say(b"kitchen")
    assert out == []
    say(b"kitchen")
    say(b"street")
    assert out == [b"kitchen", b"street"]


def test_a_publisher_that_is_connected_again_says_nothing_new():
    transport, out, _ = guard()
    connect(transport)(b"kitchen")
    connect(transport)(b"kitchen")
    connect(transport)(b"street")
    connect(transport)(b"kitchen")
    assert out == [b"kitchen", b"street", b"kitchen"]


@pytest.mark.parametrize(
    ("latching", "kind", "dry_run"),
    [
        (False, StreamKind.ACTION, False),
        (True, StreamKind.STATE, False),
        (True, StreamKind.ACTION, True),
    ],
)
def test_what_is_no_latched_goal_is_said_as_often_as_it_comes(latching, kind, dry_run):
    transport, out, _ = guard(kind=kind, dry_run=dry_run)
    for _ in range(2):
        connect(transport, latching=latching)(b"kitchen")
    assert out == [b"kitchen", b"kitchen"]


def test_what_a_guard_has_left_may_be_nonsense():
    transport, out, _ = guard(b'{"latched /goal": [1, 2]}')
    connect(transport)(b"kitchen")
    assert out == [b"kitchen"]


def test_what_is_remembered_is_bounded():
    made = stream(stage(policy=PolicyName.BLOCK, kind=StreamKind.ACTION), topic="/goal")
    transport = MemoryTransport()
    host = Host(transport, [made])
    host.open()
    latched = host.guarded[0]._latched
    for number in range(65):
        latched.once(f"/n{number}", lambda message: None)(b"x")
    taken = []
    for node in ("/n0", "/n1", "/n64"):
        latched.once(node, lambda message, node=node: taken.append(node))(b"x")
    assert taken == ["/n0", "/n1"]

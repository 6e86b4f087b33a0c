"""A latched goal is acted on once, whoever guards."""

from dataclasses import replace
from time import monotonic_ns, time_ns

import pytest
from streams import WORDS, peer, stage, stream

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import NumberedMessage, TypeInfo
from rtron.vocabulary import SECOND, CoordinationKind, Durability, PolicyName, QoS, StreamKind

IN, OUT = "/rtron/goal/flow1", "/rtron/goal/out"
KEPT = QoS(durability=Durability.TRANSIENT_LOCAL)


def guard(left=b"", kind=StreamKind.ACTION, *, left_at=0, dry_run=False):
    written = []
    will = HandoverState(left, written.append)
    will.last_seen_at = left_at
    made = stream(stage(policy=PolicyName.BLOCK, kind=kind), topic="/goal", type=WORDS.type)
    transport = MemoryTransport()
    Coordinator(transport, [made], handover=will, dry_run=dry_run).open()
    return transport, transport.listen(OUT), written


def connect(transport, node="/nav", *, latching=True):
    return transport.publisher(IN, peer(node, WORDS, latching=latching))


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
    made = stream(
        stage(policy=PolicyName.BLOCK, kind=StreamKind.ACTION), topic="/goal", type=WORDS.type
    )
    transport = MemoryTransport()
    host = Coordinator(transport, [made])
    host.open()
    latched = host.streams[0].endpoints._latch_filter
    for number in range(65):
        latched.filter(f"/n{number}", lambda message: None)(b"x")
    taken = []
    for node in ("/n0", "/n1", "/n64"):
        latched.filter(node, lambda message, node=node: taken.append(node))(b"x")
    assert taken == ["/n0", "/n1"]


def numbered(*numbers, writer="w1", text="kitchen"):
    return [NumberedMessage.of(f"{text} {number}".encode(), writer, number) for number in numbers]


def hear(transport, words, node="/nav"):
    say = transport.publisher(IN, replace(peer(node, WORDS, latching=True), qos=KEPT))
    for word in words:
        say(word)


def test_of_a_history_that_comes_again_the_next_guard_acts_on_nothing():
    transport, out, written = guard()
    hear(transport, numbered(1, 2, 3))
    assert out == numbered(1, 2, 3)
    transport, out, _ = guard(written[-1])
    hear(transport, numbered(1, 2, 3))
    assert out == []


def test_what_was_said_while_no_guard_was_there_is_new():
    """Also if it is what was said before: it was said again."""
    transport, _, written = guard()
    hear(transport, numbered(1, 2))
    transport, out, _ = guard(written[-1])
    again = NumberedMessage.of(b"kitchen 1", "w1", 3)
    hear(transport, [*numbered(1, 2), again])
    assert out == [again]


def test_a_goal_that_is_given_again_after_the_history_passes():
    transport, _, written = guard()
    hear(transport, numbered(1, 2))
    transport, out, _ = guard(written[-1])
    hear(transport, [*numbered(1, 2), *numbered(3), NumberedMessage.of(b"kitchen 1", "w1", 4)])
    assert out == [b"kitchen 3", b"kitchen 1"]


def test_a_publisher_that_was_started_again_says_something_new():
    transport, out, _ = guard()
    hear(transport, numbered(1, 2))
    hear(transport, numbered(1, writer="w2"))
    assert out == [*numbered(1, 2), *numbered(1)]


def test_two_publishers_of_one_node_are_told_apart():
    transport, _, written = guard()
    hear(transport, numbered(5))
    hear(transport, numbered(1, writer="w2"))
    transport, out, _ = guard(written[-1])
    hear(transport, numbered(5, 6))
    hear(transport, numbered(1, 2, writer="w2"))
    assert out == [*numbered(6), *numbered(2)]


@pytest.mark.parametrize(
    ("kind", "done", "expected"),
    [
        (StreamKind.COMMAND, None, True),
        (StreamKind.ACTION, None, False),
        (StreamKind.COMMAND, "/navigate/done", False),
        (StreamKind.STATE, None, False),
    ],
)
def test_only_commands_are_for_the_moment(kind, done, expected):
    made = replace(
        stream(stage(policy=PolicyName.BLOCK, kind=kind), topic="/goal", type=WORDS.type), done=done
    )
    host = Coordinator(MemoryTransport(), [made])
    host.open()
    assert host.streams[0].endpoints._is_momentary(peer("/nav", latching=True)) is expected


def test_an_array_of_numbers_moves_something_whatever_looks_at_it():
    limits = stage(kind=StreamKind.STATE, id="rsrcn")
    made = stream(replace(limits, coordination_kind=CoordinationKind.RSRCN), topic="/arm")
    host = Coordinator(MemoryTransport(), [made])
    arms = TypeInfo("std_msgs/Float64MultiArray", "4b7d974086d4060e7db4613a7e6c3ba4")
    assert host.streams[0].endpoints._is_momentary(peer("/nav", arms, latching=True))


def given(*ages):
    """Return goals that were given so long (s) before now."""
    now = time_ns()
    return [
        NumberedMessage.of(b"goal", "w1", number, now - int(age * SECOND))
        for number, age in enumerate(ages, 1)
    ]


def test_what_was_said_before_the_last_guard_was_gone_is_old():
    """That guard has left no numbers, only when it was last there."""
    words = given(3600, 60, 3)
    transport, out, _ = guard(left_at=time_ns() - 60 * SECOND)
    hear(transport, words)
    assert out == words[-1:]


def test_the_very_moment_of_the_last_sign_of_life_counts_as_before():
    words = given(60, 59)
    transport, out, _ = guard(left_at=words[0].source_time)
    hear(transport, words)
    assert out == words[1:]


def test_what_a_guard_that_was_killed_has_not_heard_is_new():
    """It was there when the second was said, and had not taken it: the numbers tell."""
    words = given(3600, 60, 3)
    transport, _, written = guard()
    hear(transport, words[:1])
    transport, out, _ = guard(written[-1], left_at=time_ns())
    hear(transport, words)
    assert out == words[1:]


def test_where_no_guard_was_before_all_that_was_kept_is_heard():
    words = given(3600, 60, 3)
    transport, out, _ = guard()
    hear(transport, words)
    assert out == words


def test_a_publisher_whose_clock_is_slow_is_heard_once_its_history_has_come(monkeypatch):
    transport, out, _ = guard(left_at=time_ns())
    say = transport.publisher(IN, replace(peer("/nav", WORDS, latching=True), qos=KEPT))
    one, other = given(3600, 3500)
    say(one)
    later = monotonic_ns() + 10 * SECOND
    monkeypatch.setattr("rtron.guard.core.latched_messages.monotonic_ns", lambda: later)
    say(other)
    assert out == [other]


def test_those_who_are_blocked_make_nobody_forgotten():
    transport, _, written = guard()
    hear(transport, numbered(1))
    for number in range(65):
        hear(transport, numbered(1, writer=f"x{number}"), node="/rogue")
    transport, out, _ = guard(written[-1])
    hear(transport, numbered(1, 2))
    assert out == numbered(2)


def test_what_a_guard_has_left_of_numbers_may_be_nonsense():
    transport, out, _ = guard(b'{"latched /goal": {"w1": "x", "w2": [3]}}')
    hear(transport, numbered(1))
    hear(transport, numbered(2, writer="w2"))
    assert out == [*numbered(1), *numbered(2)]

"""What a guarded stream keeps for late subscribers, and what waits for whom."""

import pytest
from streams import peer, stage, stream

from rtron.guard.coordinator import Coordinator
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import DEFAULT_OUTPUT
from rtron.vocabulary import SECOND, PolicyName, StreamKind

NAV, TELEOP, OUT = "/rtron/mode/flow1", "/rtron/mode/flow2", "/rtron/mode/out"


class Waits(MemoryTransport):
    """Knows for whom the first words on each topic wait."""

    def __init__(self):
        super().__init__()
        self.successors = {}

    def advertise(self, node, topic, type, options=DEFAULT_OUTPUT):
        self.successors[topic] = options.successors
        return super().advertise(node, topic, type, options)


def mode(policy, **more):
    """Guard /mode, a state; return the transport."""
    made = stream(stage(policy=policy, kind=StreamKind.STATE), topic="/mode", **more)
    transport = Waits()
    Coordinator(transport, [made]).open()
    return transport


def say(transport, words):
    """Let words of the two publishers pass, one after the other's turn; only /nav's latch."""
    nav = transport.publisher(NAV, peer("/nav", latching=True))
    teleop = transport.publisher(TELEOP, peer("/teleop"))
    for word in words:
        (nav if word.startswith(b"n") else teleop)(word)
        transport.advance(SECOND)


@pytest.mark.parametrize(
    ("words", "kept"), [((b"n1", b"t1"), [b"t1"]), ((b"t1", b"n1"), [b"n1"]), ((b"t1",), [b"t1"])]
)
def test_where_flows_take_turns_the_last_word_of_all_is_what_is_so_now(words, kept):
    transport = mode(PolicyName.PREEMPTION)
    say(transport, words)
    assert transport.listen(OUT) == kept


def test_where_they_take_none_each_has_its_own_last_word_if_it_latches():
    transport = mode(PolicyName.BLOCK)
    say(transport, [b"n1", b"n2", b"t1"])
    assert transport.listen(OUT) == [b"n2"]


def test_nothing_is_kept_where_nobody_latches():
    transport = mode(PolicyName.PREEMPTION)
    transport.publisher(NAV, peer("/nav"))(b"n1")
    assert transport.listen(OUT) == []


def test_first_words_wait_for_the_successors_and_for_a_publisher_that_listens():
    transport = mode(PolicyName.PREEMPTION, successors=("/driver", "/nav"))
    assert transport.successors[OUT] == ("/driver", "/nav")
    assert transport.successors[NAV] == ("/nav",)
    assert transport.successors["/mode"] == ()


def test_the_name_of_a_stranger_stays_on_its_line(caplog):
    transport = mode(PolicyName.PREEMPTION)
    transport.publisher("/mode", peer("/rogue\nINFO all is well\x1b[2J"))
    assert r"unapproved publisher /rogue\nINFO all is well\x1b[2J under" in caplog.text

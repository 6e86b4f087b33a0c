"""What a guard leaves to the next one."""

import json

import pytest

from rtron.guard.core.handover_state import INTRUSIONS, MOST_BYTES, RESERVED_BYTES, HandoverState
from rtron.guard.supervision.shared_memory import GuardMemory


@pytest.fixture
def page():
    made = GuardMemory.create(0)
    yield made
    made.close()


def test_without_a_supervisor_nothing_is_found():
    will = HandoverState()
    will.store("owners", {"goal": "/nav"})
    assert will.inherited("owners") is None


def test_what_one_guard_keeps_the_next_one_finds(page):
    first = HandoverState(page.handover_state.read()[1], page.handover_state.write)
    first.store("owners", {"goal é": ["/nav", None, 1.5]})
    first.store("sent", [1])
    second = HandoverState(page.handover_state.read()[1], page.handover_state.write)
    assert second.inherited("owners") == {"goal é": ["/nav", None, 1.5]}
    second.store("sent", [2])
    third = HandoverState(page.handover_state.read()[1])
    assert third.inherited("owners") == {"goal é": ["/nav", None, 1.5]}
    assert third.inherited("sent") == [2]


def test_none_is_not_kept():
    left = []
    will = HandoverState(b'{"a": 1, "b": 2}', left.append)
    will.store("a", None)
    assert json.loads(left[-1]) == {"b": 2}


def test_a_will_as_long_as_is_allowed_is_kept_and_one_byte_more_is_not(page):
    will = HandoverState(b"", page.handover_state.write)
    will.store("other", 1)
    room = MOST_BYTES - RESERVED_BYTES - len('{"other":1,"long":""}')
    will.store("long", "x" * room)
    assert HandoverState(page.handover_state.read()[1]).inherited("long") == "x" * room
    will.store("long", "x" * (room + 1))
    after = HandoverState(page.handover_state.read()[1])
    assert after.inherited("long") is None
    assert after.inherited("other") == 1


def test_there_is_room_for_intrusions_whatever_else_is_kept(page):
    will = HandoverState(b"", page.handover_state.write)
    will.store("long", "x" * (MOST_BYTES - RESERVED_BYTES - len('{"long":""}')))
    room = RESERVED_BYTES - len(',"intrusions":""')
    will.store(INTRUSIONS, "x" * room)
    assert HandoverState(page.handover_state.read()[1]).inherited(INTRUSIONS) == "x" * room
    will.store("other", 1)
    after = HandoverState(page.handover_state.read()[1])
    assert after.inherited("other") is None
    assert after.inherited(INTRUSIONS) == "x" * room


@pytest.mark.parametrize("left", [b"{", b"[1]", b"\xff", b'{"a":' * 100_000])
def test_what_is_no_will_leaves_nothing(left):
    will = HandoverState(left)
    assert will.inherited("a") is None
    will.store("a", 1)

"""What a guard leaves to the next one."""

import json

import pytest

from rtron.guard.core.handover_state import MOST_BYTES, Will
from rtron.guard.supervision.shared_memory import Page


@pytest.fixture
def page():
    made = Page.new(0)
    yield made
    made.close()


def test_without_a_supervisor_nothing_is_found():
    will = Will()
    will.keep("owners", {"goal": "/nav"})
    assert will.found("owners") is None


def test_what_one_guard_keeps_the_next_one_finds(page):
    first = Will(page.will.read()[1], page.will.write)
    first.keep("owners", {"goal é": ["/nav", None, 1.5]})
    first.keep("sent", [1])
    second = Will(page.will.read()[1], page.will.write)
    assert second.found("owners") == {"goal é": ["/nav", None, 1.5]}
    second.keep("sent", [2])
    third = Will(page.will.read()[1])
    assert third.found("owners") == {"goal é": ["/nav", None, 1.5]}
    assert third.found("sent") == [2]


def test_none_is_not_kept():
    left = []
    will = Will(b'{"a": 1, "b": 2}', left.append)
    will.keep("a", None)
    assert json.loads(left[-1]) == {"b": 2}


def test_a_will_as_long_as_is_allowed_is_kept_and_one_byte_more_is_not(page):
    will = Will(b"", page.will.write)
    will.keep("other", 1)
    room = MOST_BYTES - len('{"other":1,"long":""}')
    will.keep("long", "x" * room)
    assert Will(page.will.read()[1]).found("long") == "x" * room
    will.keep("long", "x" * (room + 1))
    after = Will(page.will.read()[1])
    assert after.found("long") is None
    assert after.found("other") == 1


@pytest.mark.parametrize("left", [b"{", b"[1]", b"\xff", b'{"a":' * 100_000])
def test_what_is_no_will_leaves_nothing(left):
    will = Will(left)
    assert will.found("a") is None
    will.keep("a", 1)

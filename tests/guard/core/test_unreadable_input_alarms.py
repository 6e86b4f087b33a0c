"""Alarms for unreadable input: active while it goes on, bounded in number, then cleared."""

import pytest

from rtron.guard.core.alarms import Alarms, UnreadableInputAlarms
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.vocabulary import SECOND, AlarmKind

CLEAR_AFTER = 10 * SECOND


@pytest.fixture
def memory():
    return MemoryTransport()


@pytest.fixture
def alarms():
    return Alarms()


@pytest.fixture
def unreadable_alarms(alarms, memory):
    return UnreadableInputAlarms(alarms, memory)


def test_it_is_one_alarm_whatever_differs_behind_the_colon(unreadable_alarms, alarms):
    unreadable_alarms.report("/a", "/evil", "a message is dropped: 3 bytes follow")
    unreadable_alarms.report("/a", "/evil", "a message is dropped: 9 bytes follow")
    (alarm,) = alarms.active
    assert (alarm.kind, alarm.topic, alarm.peer) == (AlarmKind.UNREADABLE, "/a", "/evil")
    assert alarm.reason == "/a: /evil a message is dropped"


def test_it_is_settled_when_nothing_was_wrong_for_a_while(unreadable_alarms, alarms, memory):
    unreadable_alarms.report("/a", "/evil", "is of another type")
    memory.advance(CLEAR_AFTER - 1)
    assert alarms.active
    memory.advance(1)
    assert not alarms.active


def test_it_stands_as_long_as_it_goes_on(unreadable_alarms, alarms, memory):
    for _ in range(5):
        unreadable_alarms.report("/a", "/evil", "is of another type")
        memory.advance(CLEAR_AFTER - 1)
    assert alarms.active
    assert alarms.raised == 1
    memory.advance(CLEAR_AFTER)
    assert not alarms.active


def test_who_has_no_name_is_told_too_and_names_are_shortened(unreadable_alarms, alarms):
    unreadable_alarms.report("/a", "", "is of another type")
    unreadable_alarms.report("/a", "/" + "n" * 1000, "is of another type")
    first, second = alarms.active
    assert first.reason == "/a: a node without a name is of another type"
    assert len(second.reason) == 300


def test_many_strangers_do_not_fill_the_memory(unreadable_alarms, alarms):
    for number in range(1000):
        unreadable_alarms.report("/a", f"/evil{number}", "is of another type")
    assert len(alarms.active) == 64

"""What cannot be read of others: an alarm while it goes on, bounded, settled when it is over."""

import pytest

from rtron.guard.complaints import UnreadableInputAlarms
from rtron.guard.core.alarms import Alarms
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.vocabulary import SECOND, AlarmKind

CALM = 10 * SECOND


@pytest.fixture
def memory():
    return MemoryTransport()


@pytest.fixture
def alarms():
    return Alarms()


@pytest.fixture
def complaints(alarms, memory):
    return UnreadableInputAlarms(alarms, memory)


def test_it_is_one_alarm_whatever_differs_behind_the_colon(complaints, alarms):
    complaints.report("/a", "/evil", "a message is dropped: 3 bytes follow")
    complaints.report("/a", "/evil", "a message is dropped: 9 bytes follow")
    (alarm,) = alarms.active
    assert (alarm.kind, alarm.topic, alarm.peer) == (AlarmKind.UNREADABLE, "/a", "/evil")
    assert alarm.reason == "/a: /evil a message is dropped"


def test_it_is_settled_when_nothing_was_wrong_for_a_while(complaints, alarms, memory):
    complaints.report("/a", "/evil", "is of another type")
    memory.advance(CALM - 1)
    assert alarms.active
    memory.advance(1)
    assert not alarms.active


def test_it_stands_as_long_as_it_goes_on(complaints, alarms, memory):
    for _ in range(5):
        complaints.report("/a", "/evil", "is of another type")
        memory.advance(CALM - 1)
    assert alarms.active
    assert alarms.raised == 1
    memory.advance(CALM)
    assert not alarms.active


def test_who_has_no_name_is_told_too_and_names_are_shortened(complaints, alarms):
    complaints.report("/a", "", "is of another type")
    complaints.report("/a", "/" + "n" * 1000, "is of another type")
    first, second = alarms.active
    assert first.reason == "/a: a node without a name is of another type"
    assert len(second.reason) == 300


def test_many_strangers_do_not_fill_the_memory(complaints, alarms):
    for number in range(1000):
        complaints.report("/a", f"/evil{number}", "is of another type")
    assert len(alarms.active) == 64

"""How many alarms the audit reports, and that what stops a stream is never left out."""

import pickle

import pytest

from rtron.guard.audit.ros1.registrations import MAX_NAME
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.printable import printable
from rtron.guard.lanes.bulk.remote_response import ReportedAlarms
from rtron.guard.lanes.exchange.audit_exchange import MAX_ALARMS
from rtron.guard.lanes.exchange.message_channel import MAX_MESSAGE_BYTES
from rtron.vocabulary import Alarm, AlarmKind

LONGEST = chr(0x20000)
"""A character of four bytes that can be printed."""


@pytest.fixture
def alarms():
    loop = EventLoop()
    yield ReportedAlarms(loop)
    loop.close()


def alarm(number, *streams):
    return Alarm(kind=AlarmKind.DRIFT, reason=f"alarm {number}"), streams


def test_an_alarm_without_room_is_not_reported_and_others_are(alarms):
    assert all(alarms.add(*alarm(number)) for number in range(MAX_ALARMS))
    assert not alarms.add(*alarm(-1))
    assert not alarms.remove(alarm(-1)[0])
    assert alarms.remove(alarm(0)[0])
    assert alarms.add(*alarm(-2))
    assert len(alarms.reported()) == MAX_ALARMS


def test_what_stops_a_stream_has_room_and_comes_first(alarms):
    for number in range(2 * MAX_ALARMS):
        alarms.add(*alarm(number))
    assert alarms.add(*alarm(-1, "/a"))
    assert not alarms.add(*alarm(-1, "/a"))
    assert alarms.reported()[0] == alarm(-1, "/a")


def test_an_alarm_that_stops_a_stream_now_is_reported_again(alarms):
    assert alarms.add(*alarm(0))
    assert alarms.add(*alarm(0, "/a"))
    assert alarms.add(*alarm(0, "/a", "/b"))
    assert alarms.reported() == (alarm(0, "/a", "/b"),)
    assert alarms.add(*alarm(0))
    assert alarms.reported() == (alarm(0),)


def test_each_stream_has_an_alarm_that_is_reported(alarms):
    for number in range(2 * MAX_ALARMS):
        alarms.add(*alarm(number, "/a"))
    assert alarms.add(*alarm(-1, "/a", "/b"))
    assert not alarms.add(*alarm(-2, "/b"))
    assert alarms.remove(alarm(-1, "/a", "/b")[0])
    assert alarm(-2, "/b") in alarms.take_waiting()
    assert len(alarms.reported()) == MAX_ALARMS + 1


def test_an_alarm_that_waits_can_be_taken_back(alarms):
    for number in range(MAX_ALARMS + 1):
        alarms.add(*alarm(number, "/a"))
    assert not alarms.remove(alarm(MAX_ALARMS)[0])
    assert alarms.remove(alarm(0)[0])
    assert alarms.take_waiting() == []


def test_all_that_is_reported_fits_into_a_message_well(alarms):
    topics = [f"/a_topic_with_a_rather_long_name_{number}" for number in range(50)]
    for number in range(2 * MAX_ALARMS + len(topics)):
        alarms.add(longest_alarm(number), ())
        alarms.add(longest_alarm(-number), (topics[number % len(topics)],))
    found = alarms.reported()
    assert len(found) >= 2 * MAX_ALARMS
    assert len(pickle.dumps(found)) < MAX_MESSAGE_BYTES * 0.6


def longest_alarm(number):
    """Return an alarm like that of a foreign connection, with the longest names there can be."""
    node = f"/wheel_{number:04}".ljust(MAX_NAME, LONGEST)
    name, source = (printable(f"{number:04}{kind}" + LONGEST * 999) for kind in "ns")
    topic = "/rtron/a_topic_with_a_rather_long_name/out"
    reason = f"{node} hears {topic} from {source}, which has taken the name {name}, past the guard"
    return Alarm(kind=AlarmKind.IMPOSTOR, reason=reason, topic=topic, node=node, peer=name)


@pytest.mark.parametrize("text", ["x", "\n", "\x00", "\U000e0001", LONGEST])
def test_what_strangers_choose_is_short_when_it_is_printed(text):
    assert len(printable(text * 9999)) <= 200
    assert printable(text * 9999).isprintable()

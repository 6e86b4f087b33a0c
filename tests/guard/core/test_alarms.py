"""Active alarms, and the log of those for which there is no room."""

import logging

from rtron.guard.core import alarms as module
from rtron.guard.core.alarms import Alarms
from rtron.vocabulary import SECOND, Alarm, AlarmKind


def alarm(number):
    return Alarm(kind=AlarmKind.UNREGISTERED_PUBLISHER, reason=f"ghost {number}")


def test_an_alarm_is_raised_once_and_again_after_it_was_cleared(caplog):
    caplog.set_level(logging.WARNING)
    alarms = Alarms()
    assert alarms.raise_(alarm(1), 5)
    assert not alarms.raise_(alarm(1), 6)
    assert (alarms.since(alarm(1)), alarms.raised) == (5, 1)
    alarms.clear(alarm(1))
    alarms.clear(alarm(1))
    assert alarms.raise_(alarm(1), 7)
    assert [r.getMessage().split(":")[0] for r in caplog.records] == ["alarm", "no more", "alarm"]


def test_an_alarm_without_room_is_counted_and_logged_once_a_second(monkeypatch, caplog):
    monkeypatch.setattr(module, "_MAX_ALARMS", 2)
    alarms = Alarms()
    for now in range(0, 3 * SECOND, SECOND // 10):
        for number in range(5):
            alarms.raise_(alarm(number), now)
    assert alarms.active == (alarm(0), alarm(1))
    assert alarms.raised == 2 + 30 * 3
    assert len(caplog.records) == 2 + 3


def test_a_stream_that_is_stopped_is_shown_beside_any_number_of_other_alarms():
    here, mirror = Alarms(), Alarms()
    stopped = Alarm(kind=AlarmKind.INTRUSION, reason="/cmd_vel is stopped", topic="/cmd_vel")
    for number in range(1000):
        here.raise_(Alarm(kind=AlarmKind.DRIFT, reason=str(number)), 0)
        mirror.mirror(Alarm(kind=AlarmKind.DRIFT, reason=str(number)), 0, active=True)
    here.raise_(stopped, 0)
    mirror.mirror(stopped, 0, active=True)
    assert stopped in here.active
    assert stopped in mirror.active

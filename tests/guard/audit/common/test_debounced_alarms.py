"""What looks wrong is told when it has lasted, and taken back when it is gone."""

from types import SimpleNamespace

import pytest

from rtron.guard.audit.common.alarm_response import AlarmResponse
from rtron.guard.audit.common.debounced_alarms import DebouncedAlarms
from rtron.guard.core.alarms import Alarms
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.intrusion_latch import IntrusionLatch
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.vocabulary import SECOND, Alarm, AlarmKind, OnForeign

PATIENCE = 3 * SECOND
DRIFT = Alarm(kind=AlarmKind.DRIFT, reason="a remap is missing", node="/nav")
OTHER = Alarm(kind=AlarmKind.DRIFT, reason="another one", node="/driver")


class DebouncedScene:
    """The alarms that stand after each look."""

    def __init__(self, patience=PATIENCE):
        self.alarms = Alarms()
        intrusions = IntrusionLatch(HandoverState())
        host = SimpleNamespace(alarms=self.alarms, streams=[], intrusions=intrusions)
        response = AlarmResponse(host, MemoryTransport(), OnForeign.STOP, dry_run=False)
        self._standing = DebouncedAlarms(response, patience)

    def at(self, now, *alarms):
        self._standing.update(alarms, now)
        return self.alarms.active


@pytest.fixture
def looked():
    return DebouncedScene()


def test_what_lasts_is_told_once_and_not_before_it_has_lasted(looked):
    assert looked.at(SECOND, DRIFT) == ()
    assert looked.at(SECOND + PATIENCE - 1, DRIFT) == ()
    assert looked.at(SECOND + PATIENCE, DRIFT) == (DRIFT,)
    assert looked.at(SECOND + 2 * PATIENCE, DRIFT) == (DRIFT,)
    assert looked.alarms.raised == 1


def test_what_was_gone_in_between_has_to_last_anew(looked):
    looked.at(0, DRIFT)
    looked.at(PATIENCE - 1)
    assert looked.at(PATIENCE, DRIFT) == ()
    assert looked.at(2 * PATIENCE, DRIFT) == (DRIFT,)


def test_what_is_gone_is_taken_back_and_the_rest_stays(looked):
    looked.at(0, DRIFT, OTHER)
    assert set(looked.at(PATIENCE, DRIFT, OTHER)) == {DRIFT, OTHER}
    assert looked.at(PATIENCE + 1, OTHER) == (OTHER,)
    assert looked.at(PATIENCE + 2) == ()


def test_without_patience_it_is_told_at_once():
    assert DebouncedScene(patience=0).at(0, DRIFT) == (DRIFT,)

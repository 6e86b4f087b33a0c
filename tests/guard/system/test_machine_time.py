"""The clock that nobody sets, and what a faked one does to the guard."""

import time

import pytest

from rtron.errors import SourceError
from rtron.guard.incidents.recorder import machine_wall_offset
from rtron.guard.system.machine_time import check_steady_clock


def test_a_steady_clock_before_its_start_is_refused(monkeypatch):
    check_steady_clock()
    monkeypatch.setattr(time, "monotonic_ns", lambda: -1)
    with pytest.raises(SourceError, match="negative") as error:
        check_steady_clock()
    assert "FAKETIME_DONT_FAKE_MONOTONIC=1" in error.value.help


def test_an_incident_is_never_before_1970(monkeypatch):
    monkeypatch.setattr(time, "time_ns", lambda: -1)
    assert machine_wall_offset() == 0

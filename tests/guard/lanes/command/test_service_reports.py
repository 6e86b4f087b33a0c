"""Events on their way to the bulk process: a few at a time, and none lost without a word."""

from types import SimpleNamespace

import pytest
from settings_app import Base

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.lanes.command import service_reports as module
from rtron.guard.lanes.command.service_reports import ServiceReports
from rtron.guard.settings.in_force import SettingsInForce
from rtron.vocabulary import EventKind


class Line:
    """A connection to a bulk process that reads when a test says so."""

    def __init__(self):
        self.connect_listeners = []
        self.is_connected = self.is_ready = False
        self.sent = []

    def on(self, **handlers):
        """Call nothing."""

    def call(self, name, *arguments):
        if name == "event":
            at, kind, _, values = arguments
            self.sent.append(SimpleNamespace(at=at, kind=kind, values=values))

    def connect(self):
        self.is_connected = self.is_ready = True
        for listener in self.connect_listeners:
            listener()


@pytest.fixture
def reporting():
    loop, line = EventLoop(), Line()
    base = Base()
    reports = ServiceReports(line, base.host, loop, SettingsInForce(base.applying))
    yield SimpleNamespace(loop=loop, line=line, record=reports.record)
    loop.close()


def pass_time(reporting, condition):
    for _ in range(1000):
        if condition():
            return
        reporting.loop.step(0.02)
    raise AssertionError


def test_what_waits_goes_in_small_portions_in_order_and_with_its_own_time(reporting):
    for number in range(100):
        reporting.record(EventKind.GUARD, reason=str(number))
    reporting.line.connect()
    assert len(reporting.line.sent) == module._EVENTS_AT_ONCE
    pass_time(reporting, lambda: len(reporting.line.sent) == 100)
    assert [each.values["reason"] for each in reporting.line.sent] == list(map(str, range(100)))
    times = [each.at for each in reporting.line.sent]
    assert times == sorted(times)


def test_nothing_goes_while_the_other_process_reads_nothing(reporting):
    reporting.line.connect()
    reporting.line.is_ready = False
    for number in range(5):
        reporting.record(EventKind.GUARD, reason=str(number))
    for _ in range(5):
        reporting.loop.step(0.02)
    assert reporting.line.sent == []
    reporting.line.is_ready = True
    pass_time(reporting, lambda: len(reporting.line.sent) == 5)


def test_what_has_no_room_is_counted_and_told(reporting, monkeypatch):
    monkeypatch.setattr(module, "MAX_PENDING_EVENTS", 10)
    for number in range(13):
        reporting.record(EventKind.GUARD, reason=str(number))
    reporting.line.connect()
    pass_time(reporting, lambda: len(reporting.line.sent) == 10)
    reporting.record(EventKind.GUARD, reason="later")
    pass_time(reporting, lambda: len(reporting.line.sent) == 12)
    lost, later = reporting.line.sent[10:]
    assert (lost.kind, lost.values["values"]) == (EventKind.LOST, {"events": 3})
    assert later.values["reason"] == "later"

"""Reports of incidents that guards send: stored and answered, or the connection ends."""

import json

import pytest
from collector_server import hello, receive_message, send_message
from failing_database import read_only
from harness import wait_for
from incident_reports import a_report
from websockets.exceptions import ConnectionClosed

from rtron.service.collector import guard_connection
from rtron.service.collector.close_codes import CloseCode
from rtron.service.store.incidents import INCIDENT_MESSAGE, find_incident, incident_page
from rtron.wire.common.incident_report import MAX_POINTS, report_document
from rtron.wire.common.link_protocol import IncidentSaved, IncidentStored, NewSettings

SECOND_NAME = "20270115T080100.000Z-alarm.mcap"


@pytest.fixture
def quick(monkeypatch):
    """Let reports come as fast as they are answered."""
    monkeypatch.setattr(guard_connection, "MIN_INCIDENT_INTERVAL_S", 0.0)


def stored(world):
    with world.collector.database.session() as session:
        return [
            (each.robot, each.name) for each in incident_page(session, None, None, 99).incidents
        ]


class Console:
    """Keeps what is told live."""

    def __init__(self):
        self.messages = []
        self.put = self.messages.append


def test_a_report_is_stored_answered_and_live(world, quick):
    console = Console()
    world.hub.add_listener(console)
    with world.guard() as socket:
        send_message(socket, IncidentSaved(report=a_report()))
        assert receive_message(socket) == IncidentStored(name=a_report().name)
        send_message(socket, IncidentSaved(report=a_report(SECOND_NAME)))
        assert receive_message(socket) == IncidentStored(name=SECOND_NAME)
    assert stored(world) == [("one", SECOND_NAME), ("one", a_report().name)]
    assert console.messages.count(INCIDENT_MESSAGE) == 2


def test_a_report_that_comes_again_is_answered_again(world, quick):
    with world.guard() as socket:
        for reason in ("first", "second"):
            send_message(socket, IncidentSaved(report=a_report(reason=reason)))
            assert receive_message(socket) == IncidentStored(name=a_report().name)
    assert len(stored(world)) == 1


def test_the_settings_say_that_reports_are_taken(small):
    with small.connect() as socket:
        send_message(socket, hello())
        settings = receive_message(socket)
    assert isinstance(settings, NewSettings)
    assert settings.takes_incidents


def refused(world, frame):
    """Return how the connection ends of a guard that sends this."""
    with world.guard() as socket:
        socket.send(frame if isinstance(frame, str) else json.dumps(frame))
        return end_of(socket)


def end_of(socket):
    """Return how the service closes a connection, whatever it says before."""
    try:
        while True:
            receive_message(socket)
    except ConnectionClosed as error:
        return error.rcvd and error.rcvd.code


def message(**values):
    return {"type": "incident", "report": {**report_document(a_report()), **values}}


HOSTILE = {
    "a path as its name": {"name": "../../etc/passwd.mcap"},
    "a name with markup": {"name": "<img src=x>.mcap"},
    "a name too long": {"name": f"{'x' * 130}.mcap"},
    "a text too long": {"publisher": "x" * 161},
    "a control character": {"owner": "a\x1bb"},
    "a NUL": {"app": "a\0b"},
    "no cause": {"causes": []},
    "another kind": {"gravest": {**message()["report"]["gravest"], "kind": "<b>"}},
    "a time before all": {"at": -1},
    "a time that no database holds": {"at": 1 << 63},
    "a step of nothing": {"step": 0},
    "too many places": {"path": [[0, 0]] * 201},
    "a place without y": {"path": [[0]]},
    "a place far away": {"path": [[0, 1e7]]},
    "a text for a number": {"begin": "NaN"},
    "too many areas": {"areas": message()["report"]["areas"] * 11},
    "too many topics": {"topics": message()["report"]["topics"] * 5},
    "no list": {"alternatives": {}},
    "a list in a list": {"causes": [[]]},
}


@pytest.mark.parametrize("what", HOSTILE)
def test_what_is_no_report_ends_the_connection(small, what):
    assert refused(small, message(**HOSTILE[what])) == CloseCode.MALFORMED
    assert stored(small) == []


@pytest.mark.parametrize("value", ["NaN", "Infinity", "1e400", "true", '"1"', "[1]"])
def test_no_speed_is_anything_but_a_number(small, value):
    document = message()
    document["report"]["topics"][0]["output"] = ["@"]
    frame = json.dumps(document).replace('"@"', value)
    assert refused(small, frame) == CloseCode.MALFORMED


def test_too_many_speeds_are_refused(small):
    document = message()
    document["report"]["topics"][0]["output"] = [0.1] * (MAX_POINTS + 1)
    assert refused(small, document) == CloseCode.MALFORMED


def test_what_nobody_asked_for_is_not_stored(small):
    with small.guard() as socket:
        socket.send(json.dumps(message(extra={"x": "y" * 10_000})))
        assert isinstance(receive_message(socket), IncidentStored)
    with small.collector.database.session() as session:
        assert "extra" not in find_incident(session, "one", a_report().name).report


def test_a_flood_of_reports_ends_the_connection(small):
    with small.guard() as socket:
        for name in (a_report().name, SECOND_NAME):
            send_message(socket, IncidentSaved(report=a_report(name)))
        assert end_of(socket) == CloseCode.TOO_MUCH
    assert stored(small) == [("one", a_report().name)]


def test_what_cannot_be_stored_is_not_answered_and_may_come_again(small, quick, caplog):
    with small.guard() as socket:
        with read_only(small.collector.database):
            send_message(socket, IncidentSaved(report=a_report()))
            wait_for(lambda: "an incident is not stored" in caplog.text)
        send_message(socket, IncidentSaved(report=a_report(SECOND_NAME)))
        assert receive_message(socket) == IncidentStored(name=SECOND_NAME)
        send_message(socket, IncidentSaved(report=a_report()))
        assert receive_message(socket) == IncidentStored(name=a_report().name)

"""`rtron events --follow` where not every event is told live."""

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from harness import wait_for

from rtron.service.collector.data_collector import MAX_LIVE_EVENTS
from rtron.service.store.events import EventBatch, add_events
from rtron.service.store.robots import register_robot
from rtron.vocabulary import EventKind, GuardEvent, GuardEventLevel


@pytest.fixture
def store(app):
    """Store events in one transaction, and tell of them as the collector does."""
    service, collector = app.state.service, app.state.collector

    def store(first, last):
        with service.database.session() as session:
            robot = register_robot(session, "car1", service.clock())
            batch = EventBatch(robot.id, "car1", tuple(map(event, range(first, last + 1))))
            added = add_events(session, service.clock(), [batch])
        collector._note_stored(added, last + 1 - first)

    return store


def event(number):
    level = GuardEventLevel.WARNING if number % 7 == 0 else GuardEventLevel.INFO
    return GuardEvent(run="r", number=number, at=number, kind=EventKind.ALARM, level=level)


@pytest.fixture
def follow(port, people, tmp_path):
    """Return the command that follows events from now on, in JSON."""
    secret = people.token_headers("t", "read")["Authorization"].split()[1]
    (tmp_path / "t").write_text(secret)
    where = ["--service", f"http://127.0.0.1:{port}", "--token-file", str(tmp_path / "t")]
    words = ["events", "-f", "-n", "0", "--format", "json", *where]
    return [sys.executable, "-m", "rtron", *words]


def is_asleep(pid):
    """Return whether a process waits for something (proc(5): stat)."""
    return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "S"


def test_who_ends_it_sees_nothing_more(app, store, follow):
    store(1, 5)
    with subprocess.Popen(follow, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        try:
            wait_for(lambda: len(app.state.service.hub._listeners) == 2)
            store(6, 6)
            assert json.loads(process.stdout.readline())["at"] == 6
            wait_for(lambda: is_asleep(process.pid))
            process.send_signal(signal.SIGINT)
            assert process.communicate(timeout=60) == (b"", b"")
        finally:
            process.kill()


@pytest.mark.parametrize("level", ["info", "warning"])
def test_each_event_of_a_storm_is_shown_once(app, store, follow, level):
    store(1, 5)
    command = [*follow, "--level", level]
    hub = app.state.service.hub
    with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
        try:
            wait_for(lambda: len(hub._listeners) == 2)
            last = 5 + 5 * MAX_LIVE_EVENTS
            store(6, last)
            store(last + 1, last + 3)
            store(last + 4, last + 14)
            wanted = [
                number for number in range(6, last + 15) if level == "info" or number % 7 == 0
            ]
            assert [json.loads(process.stdout.readline())["at"] for _ in wanted] == wanted
        finally:
            process.kill()

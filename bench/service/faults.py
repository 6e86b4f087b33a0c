"""The service and the guard killed at random under load: what is lost, what is stored twice.

Each life of the guard numbers its events, so what the service has of it must have no holes. What a
killed guard took with it must be told, and fit into the window that is stated (100 ms). Settings
that the service has acknowledged must be there for ever.
"""

import os
import random
import signal
import sqlite3
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing
from dataclasses import dataclass, field
from http.client import HTTPException
from typing import Any
from urllib.error import URLError

from bench.common.testbed import ReportProgress, Testbed
from bench.common.workload import KILLS
from bench.ros1.node import guard_pid
from bench.service.link import NOISE, ROBOT, run_guard_with_noise
from bench.service.service_process import ServiceProcess
from figures.figure import Figure

_WINDOW_S = 0.1
_PATIENCE_S = 60.0
_SEED = 6


@dataclass(slots=True)
class _AcknowledgedSettings:
    """The settings that were acknowledged: the limit by revision."""

    acknowledged: dict[int, float] = field(default_factory=dict)

    def change(self, service: ServiceProcess, limit: float) -> None:
        """Ask for a limit; what is not acknowledged may be in force or not."""
        try:
            view = service.change(ROBOT, {"rsrcn": {"max_vel_limit": limit}})
        except (URLError, HTTPException, OSError):
            return
        self.acknowledged[view["revision"]] = limit

    def lost(self, database: str) -> int:
        """Return how many of them the database does not have as they were."""
        query = (
            "SELECT revision, json_extract(document, '$.nodes.rsrcn.max_vel_limit') FROM settings"
        )
        stored = dict(_rows(database, query))
        return sum(stored.get(revision) != limit for revision, limit in self.acknowledged.items())


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Kill, and give what was lost."""
    chance, settings = random.Random(_SEED), _AcknowledgedSettings()
    with ExitStack() as stack:
        service = stack.enter_context(ServiceProcess(testbed.folder, "", "--log-level", "warning"))
        token = service.create_token(ROBOT, "guard", robot=ROBOT)
        stack.enter_context(run_guard_with_noise(testbed, service, token))
        _wait(lambda: _connected(service), "the guard")
        for number in range(1, KILLS + 1):
            progress(f"kill {number} of {KILLS}")
            _kill_service(service, settings, chance)
            _kill_guard(testbed, service, settings, chance)
        _wait(lambda: _connected(service), "the guard")
        last = settings.acknowledged[max(settings.acknowledged)]
        settings.change(service, last)
        _wait(lambda: _applied(service), "the last settings in force")
    yield from _loss_figures(service.database, settings)


def _kill_service(
    service: ServiceProcess, settings: _AcknowledgedSettings, chance: random.Random
) -> None:
    time.sleep(chance.uniform(0.0, 0.5))
    settings.change(service, chance.uniform(0.2, 0.9))
    time.sleep(chance.uniform(0.0, 0.05))
    service.stop(signal.SIGKILL)
    time.sleep(chance.uniform(0.0, 0.5))
    service.start()


def _kill_guard(
    testbed: Testbed,
    service: ServiceProcess,
    settings: _AcknowledgedSettings,
    chance: random.Random,
) -> None:
    master = testbed.environ["ROS_MASTER_URI"]
    time.sleep(chance.uniform(0.0, 1.0))
    settings.change(service, chance.uniform(0.2, 0.9))
    time.sleep(chance.uniform(0.0, 0.05))
    before = guard_pid(master)
    os.kill(before, signal.SIGKILL)
    _wait(lambda: guard_pid(master) not in (0, before), "the next guard")


def _loss_figures(database: str, settings: _AcknowledgedSettings) -> Iterator[Figure]:
    runs = _rows(database, "SELECT run, count(*), max(number) FROM events GROUP BY run")
    reported_losses = _rows(
        database, "SELECT json_extract(\"values\", '$.events') FROM events WHERE kind='lost'"
    )
    names = _rows(database, "SELECT count(DISTINCT run || ':' || number), count(*) FROM events")[0]
    unit = f"of {len(settings.acknowledged)} acknowledged settings, {2 * KILLS} kills"
    yield Figure("faults.settings_lost", settings.lost(database), None, unit, at_most=0)
    holes = sum(most - count for _, count, most in runs)
    yield Figure("faults.events_missing", holes, None, f"of {names[1]:,} events", at_most=0)
    twice = names[1] - names[0]
    yield Figure("faults.events_twice", twice, None, f"of {names[1]:,} events", at_most=0)
    worst = max((count for (count,) in reported_losses), default=0)
    allowed = _WINDOW_S * NOISE + 1
    expected_events = KILLS * NOISE
    yield Figure(
        "faults.events", names[1], None, "events, so the load was there", at_least=expected_events
    )
    unit = f"events told as lost with one guard ({NOISE} a second)"
    yield Figure("faults.crash_window", worst, None, unit, at_most=allowed)
    guard_runs = sum(not run.startswith("link-") for run, _, _ in runs)
    yield Figure("faults.lives", guard_runs, None, "lives of the guard", at_least=KILLS + 1)


def _rows(database: str, query: str) -> list[tuple[Any, ...]]:
    with closing(sqlite3.connect(database)) as connection:
        return connection.execute(query).fetchall()


def _connected(service: ServiceProcess) -> bool:
    robot = service.state(ROBOT)
    return bool(robot and robot["connected"])


def _applied(service: ServiceProcess) -> bool:
    return bool(service.request(f"/api/v1/robots/{ROBOT}/settings")["outcome"] == "applied")


def _wait(condition: Callable[[], object], what: str) -> None:
    deadline = time.monotonic() + _PATIENCE_S
    while not condition():
        if time.monotonic() > deadline:
            raise TimeoutError(what)
        time.sleep(0.02)

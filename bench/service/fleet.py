"""One service and a fleet: simulated guards over the real link, people's requests beside them.

The guards of a fleet run in one process of their own, one event and one state a second each. First
the service is measured with guards alone, then while somebody changes settings, stops robots, reads
and looks at the console. At last it is killed; all guards come back, and what it acknowledged must
be there once.
"""

import json
import signal
import subprocess
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.request import Request, urlopen

from sqlalchemy import text

from bench.common.latency import quantile
from bench.common.process_usage import processor_ns, resident_mb
from bench.common.testbed import ReportProgress, Testbed, end, python, start
from bench.common.workload import FLEET_SECONDS, FLEETS, SETTLE_SECONDS
from bench.service.service_process import ServiceProcess
from figures.figure import Figure
from rtron.service.domain.principal import AccessScope
from rtron.service.store.accounts.tokens import TokenSpec, create_token
from rtron.service.store.database import Database

_LIMIT_S = 300
"""The guards' process ends after so many seconds, whatever happens."""
_CONNECT_S = 60.0
_BACK_S = 40.0
_ANSWER_S = 10.0
_SHARE, _EVENT_MS, _IN_FORCE_MS, _RESTART_S = 60, 1000, 300, 10


@dataclass(slots=True)
class _Requests:
    """How long people's requests took, ns, by what was asked for, and how many failed."""

    took: dict[str, list[int]] = field(default_factory=dict)
    failed: dict[str, int] = field(default_factory=dict)

    def time(self, name: str, request: Callable[[], object]) -> None:
        """Time a request; one that fails counts with the time that it took."""
        begin = time.perf_counter_ns()
        try:
            request()
        except (OSError, TimeoutError):
            self.failed[name] = self.failed.get(name, 0) + 1
        self.took.setdefault(name, []).append(time.perf_counter_ns() - begin)


class Fleet:
    """The guards' process."""

    def __init__(self, process: subprocess.Popen[str], size: int) -> None:
        self._process, self._size = process, size

    def report(self, bad: Sequence[str] | None = None) -> dict[str, Any]:
        """Return what the guards saw since the last report; from then on `bad` ones are bad."""
        assert self._process.stdin
        assert self._process.stdout
        self._process.stdin.write("\n" if bad is None else f"{json.dumps(bad)}\n")
        self._process.stdin.flush()
        report: dict[str, Any] = json.loads(self._process.stdout.readline())
        return report

    def wait_connected(self, since: float, limit_s: float) -> float:
        """Return how many seconds after `since` all were connected; `limit_s` if they were not."""
        connects = 0
        while time.monotonic() - since < limit_s:
            report = self.report()
            connects += report["connects"]
            if report["connected"] == self._size and connects >= self._size:
                return float(report["last_connected"]) - since
            time.sleep(0.5)
        return limit_s

    def wait_back(self, since: float, limit_s: float) -> float:
        """Return how many seconds after `since` all are connected again; `limit_s` if not."""
        has_lost = False
        while time.monotonic() - since < limit_s:
            report = self.report()
            has_lost = has_lost or report["connected"] < self._size or report["connects"] > 0
            if has_lost and report["connected"] == self._size:
                return float(report["last_connected"]) - since
            time.sleep(0.1)
        return limit_s


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give the figures of each fleet."""
    for size in FLEETS:
        folder = testbed.folder / f"fleet{size}"
        folder.mkdir()
        tokens = create_tokens(folder / "service.sqlite", size)
        with (
            ServiceProcess(folder, folder / "service.sqlite", "--log-level", "warning") as service,
            run_fleet(testbed, service.port, tokens) as fleet,
        ):
            yield from _fleet_figures(service, fleet, size, progress)


def _fleet_figures(
    service: ServiceProcess, fleet: Fleet, size: int, progress: ReportProgress
) -> Iterator[Figure]:
    name = f"fleet.{size}"
    progress(f"{size} guards connect")
    took = fleet.wait_connected(time.monotonic(), _CONNECT_S)
    yield Figure(f"{name}.connect", took, None, "s until all are connected")
    progress(f"{size} guards alone")
    yield from _load_figures(service, fleet, name)
    progress(f"{size} guards and people")
    yield from people_figures([service], fleet, name, size)
    progress(f"{size} guards after a kill")
    yield from _restart_figures(service, fleet, name)


def _load_figures(service: ServiceProcess, fleet: Fleet, name: str) -> Iterator[Figure]:
    time.sleep(SETTLE_SECONDS)
    fleet.report()
    share = _processor_share(service.pid)
    yield Figure(f"{name}.processor", share, None, "% of a core", at_most=_SHARE)
    report = fleet.report()
    yield from event_figures(name, report)
    yield Figure(f"{name}.memory", resident_mb(service.pid), None, "MB")
    yield Figure(f"{name}.waiting", report["waiting"], None, "events not stored at the end")
    yield Figure(f"{name}.dropped", sum(report["failures"].values()), None, "guards", at_most=0)


def event_figures(name: str, report: Mapping[str, Any]) -> Iterator[Figure]:
    """Give how long events took until they were stored."""
    delays = sorted(report["delays_ns"]) or [int(1e9 * _LIMIT_S)]
    unit = f"ms till stored, of {len(report['delays_ns'])}"
    yield Figure(f"{name}.event_median", quantile(delays, 0.5) / 1e3, None, unit)
    yield Figure(f"{name}.event_p99", quantile(delays, 0.99) / 1e3, None, unit, at_most=_EVENT_MS)


def _processor_share(pid: int) -> float:
    """Return the share of a core that a process uses while nothing else is asked of it, %."""
    before, begin = processor_ns(pid), time.monotonic_ns()
    time.sleep(FLEET_SECONDS)
    return 100 * (processor_ns(pid) - before) / (time.monotonic_ns() - begin)


def people_figures(
    services: Sequence[ServiceProcess], fleet: Fleet, name: str, size: int
) -> Iterator[Figure]:
    """Give how long people's requests took, one to each service in turn."""
    requests, in_force = _ask(services, size)
    yield from _request_figures(name, requests)
    ordered = sorted(in_force) or [int(1e9 * _ANSWER_S)]
    unit = "ms from the request to the guard's stored word"
    yield Figure(f"{name}.in_force_median", quantile(ordered, 0.5) / 1e3, None, unit)
    p99 = quantile(ordered, 0.99) / 1e3
    yield Figure(f"{name}.in_force_p99", p99, None, unit, at_most=_IN_FORCE_MS)
    dropped = sum(fleet.report()["failures"].values())
    yield Figure(f"{name}.dropped_beside_people", dropped, None, "guards", at_most=0)


def _ask(services: Sequence[ServiceProcess], size: int) -> tuple[_Requests, list[int]]:
    """Ask one robot after the other for everything, as long as a fleet is measured."""
    requests, in_force, deadline = _Requests(), [], time.monotonic() + FLEET_SECONDS
    number = 0
    while time.monotonic() < deadline:
        service, robot = services[number // 2 % len(services)], f"robot{number % size}"
        path = f"/api/v1/robots/{robot}"
        requests.time("healthz", lambda: _get(f"{service.url}/healthz"))  # noqa: B023 - at once
        requests.time("console", lambda: _get(f"{service.url}/"))  # noqa: B023 - at once
        requests.time("settings", lambda: service.request(f"{path}/settings"))  # noqa: B023 - at once
        requests.time("robots", lambda: service.request("/api/v1/robots?limit=100"))  # noqa: B023 - at once
        requests.time("stop", lambda: in_force.append(_stop(service, path)))  # noqa: B023 - at once
        number += 1
    return requests, in_force


def _stop(service: ServiceProcess, path: str) -> int:
    """Stop a robot; return how long it took until the guard's word was stored, ns."""
    begin = time.time_ns()
    revision = service.request(f"{path}/stop", "POST", {"reason": f"at {begin}"})["revision"]
    deadline = time.monotonic() + _ANSWER_S
    while time.monotonic() < deadline:
        view = service.request(f"{path}/settings")
        if view["revision"] == revision and view["outcome"] == "applied":
            return int(view["answered"]) - begin
        time.sleep(0.02)
    return int(1e9 * _ANSWER_S)


def _request_figures(name: str, requests: _Requests) -> Iterator[Figure]:
    for asked, took in requests.took.items():
        took.sort()
        unit = f"ms, the slowest of {len(took)}"
        yield Figure(f"{name}.{asked}_median", quantile(took, 0.5) / 1e3, None, "ms")
        yield Figure(f"{name}.{asked}_worst", took[-1] / 1e6, None, unit)
    failed, total = sum(requests.failed.values()), sum(map(len, requests.took.values()))
    yield Figure(f"{name}.failed_requests", failed, None, f"of {total}", at_most=0)


def _restart_figures(service: ServiceProcess, fleet: Fleet, name: str) -> Iterator[Figure]:
    fleet.report()
    service.stop(signal.SIGKILL)
    killed = time.monotonic()
    service.start()
    ready = time.monotonic()
    back = fleet.wait_connected(killed, _BACK_S) - (ready - killed)
    unit = f"s after it was ready again, {ready - killed:.1f} s after the kill"
    yield Figure(f"{name}.back", back, None, unit, at_most=_RESTART_S)
    acknowledged = fleet.report()["acknowledged"]
    lost, doubled = losses(service.database, acknowledged)
    unit = f"of {sum(acknowledged.values()):,} acknowledged events"
    yield Figure(f"{name}.lost", lost, None, unit, at_most=0)
    yield Figure(f"{name}.doubled", doubled, None, unit, at_most=0)


def losses(database: str, acknowledged: Mapping[str, int]) -> tuple[int, int]:
    """Return how many acknowledged events are not there, and how many are there twice."""
    query = "SELECT run, number, count(*) FROM events GROUP BY run, number"
    with closing(Database(database)) as opened, opened.session() as session:
        rows = session.execute(text(query)).all()
    stored: dict[str, set[int]] = {}
    for run, number, _ in rows:
        stored.setdefault(run, set()).add(number)
    lost = sum(
        len(set(range(1, last + 1)) - stored.get(robot, set()))
        for robot, last in acknowledged.items()
    )
    return lost, sum(times - 1 for *_, times in rows)


@contextmanager
def run_fleet(
    testbed: Testbed, port: int, tokens: Mapping[str, str], limit_s: float = _LIMIT_S
) -> Iterator[Fleet]:
    """Run guards of robots with these tokens until the end of the block, for `limit_s` at most."""
    command = python("bench.service.fleet_guards", str(port), str(limit_s))
    process = start(testbed, command, piped=True)
    try:
        assert process.stdin
        process.stdin.write(json.dumps(tokens) + "\n")
        process.stdin.flush()
        yield Fleet(process, len(tokens))
    finally:
        end(process)


def create_tokens(location: Path | str, size: int) -> dict[str, str]:
    """Make the database with a token for each robot; the service takes it over."""
    database = Database(location)
    with database.session() as session:
        tokens = {}
        for robot in (f"robot{index}" for index in range(size)):
            spec = TokenSpec(name=robot, scopes=[AccessScope.GUARD], robot=robot)
            tokens[robot] = create_token(session, time.time_ns(), "bench", spec)[1]
    database.close()
    return tokens


def _get(url: str) -> bytes:
    with urlopen(Request(url), timeout=_ANSWER_S) as answer:
        body: bytes = answer.read()
    return body

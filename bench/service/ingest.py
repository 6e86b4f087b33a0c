"""How fast the security service takes events: a million over WebSockets, into SQLite.

The peer is Python's sqlite3 with the same rows, tables and indexes, 2,000 rows a transaction, and
nothing around it: no network, no JSON, no check. Each guard has 4,000 events on their way, so that
a batch waits for what is before it. Pages are asked for when all is stored.
"""

import json
import sqlite3
import subprocess
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

from bench.common.latency import quantile
from bench.common.process_usage import peak_resident_mb
from bench.common.testbed import ReportProgress, Testbed, end, python, start
from bench.common.workload import INGEST_SECONDS, INGESTED
from bench.service.console import page_loads
from bench.service.ingest_processes import batches
from bench.service.ingest_service import FILE
from figures.figure import Figure
from rtron.service.store.database import Database
from rtron.service.store.event_pages import EventFilter, event_page
from rtron.service.store.events import event_row
from rtron.service.store.time_series import robot_time_series as stored_figures
from rtron.vocabulary import GuardEventLevel

_ROBOTS = 4
_AT_LEAST = 5000
_PAGE_MS = 1000
_MEMORY_MB = 300
_ROWS = 2000
_PAGES = {
    "newest": EventFilter(),
    "errors": EventFilter(level=GuardEventLevel.ERROR),
    "text": EventFilter(text="nobody said that"),
}
_HOUR = 3_600_000_000_000


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give the sustained rate, the peak of memory, the time of a batch, and the time of pages."""
    folder = testbed.folder / "ingest"
    folder.mkdir()
    with _service(testbed, folder) as (process, server_info):
        progress(f"{INGESTED:,} events from {_ROBOTS} guards")
        result = _load(testbed, server_info)
        peak = peak_resident_mb(process.pid)
    progress(f"{INGESTED:,} rows by sqlite3 alone")
    rate, bound = result["stored"] / result["seconds"], _plain_rate(folder)
    yield Figure("ingest.rate", rate, bound, "events/s (more is better)", at_least=_AT_LEAST)
    yield Figure("ingest.lost", INGESTED - result["stored"], None, "events", at_most=0)
    yield Figure("ingest.memory", peak, None, "MB, the service's peak", at_most=_MEMORY_MB)
    delays = sorted(result["delays_ns"])
    for name, part in (("median", 0.5), ("p99", 0.99)):
        yield Figure(f"ingest.batch_{name}", quantile(delays, part) / 1e3, None, "ms till stored")
    progress("pages")
    yield from _pages(folder)
    progress("the console")
    yield from page_loads(folder, folder / FILE, f"ms with {INGESTED:,} events")


@contextmanager
def _service(
    testbed: Testbed, folder: Path
) -> Iterator[tuple[subprocess.Popen[str], dict[str, Any]]]:
    """Run the service; give its process, and its port and tokens."""
    command = python("bench.service.ingest_service", str(folder), str(_ROBOTS))
    process = start(testbed, command, piped=True)
    try:
        assert process.stdout
        yield process, json.loads(process.stdout.readline())
    finally:
        end(process)


def _load(testbed: Testbed, server_info: dict[str, Any]) -> dict[str, Any]:
    command = python(
        "bench.service.ingest_processes",
        str(server_info["port"]),
        str(INGESTED),
        str(INGEST_SECONDS),
    )
    process = start(testbed, command, piped=True)
    try:
        printed = process.communicate(json.dumps(server_info["tokens"]))[0]
    finally:
        end(process)
    result: dict[str, Any] = json.loads(printed)
    return result


def _plain_rate(folder: Path) -> float:
    """Return how many of the same rows a second sqlite3 alone stores."""
    database = Database(folder / "plain.db")
    database.close()
    with closing(sqlite3.connect(folder / "plain.db")) as plain:
        plain.execute("PRAGMA synchronous=NORMAL")
        spent = sum(_insert(plain, rows) for rows in _rows())
    return INGESTED / spent


def _insert(plain: sqlite3.Connection, rows: Sequence[dict[str, Any]]) -> float:
    """Store rows in one transaction; return how long that takes, s."""
    columns, marks = ", ".join(f'"{name}"' for name in rows[0]), ", ".join("?" * len(rows[0]))
    values = [tuple(each.values()) for each in rows]
    begin = time.perf_counter()
    with plain:
        plain.executemany(f"INSERT INTO events ({columns}) VALUES ({marks})", values)
    return time.perf_counter() - begin


def _rows() -> Iterator[list[dict[str, Any]]]:
    """Yield the rows of all guards, what one transaction has at a time."""
    waiting: list[dict[str, Any]] = []
    for robot in range(_ROBOTS):
        for batch in batches(f"robot{robot}", INGESTED // _ROBOTS):
            found = (event_row(robot + 1, 0, event) for event in batch)
            waiting += [each | {"values": json.dumps(each["values"])} for each in found]
            if len(waiting) >= _ROWS:
                yield waiting
                waiting = []
    if waiting:
        yield waiting


def _pages(folder: Path) -> Iterator[Figure]:
    """Give how long the API's queries take on what is stored."""
    database = Database(folder / FILE)
    unit = f"ms of {INGESTED:,} events"
    for name, event_filter in _PAGES.items():
        with database.session() as session:
            spent = _ms(lambda: event_page(session, event_filter))  # noqa: B023 - called at once
        yield Figure(f"ingest.page_{name}", spent, None, unit, at_most=_PAGE_MS)
    with database.session() as session:
        now = time.time_ns()
        spent = _ms(lambda: stored_figures(session, "robot0", now - _HOUR, now + 48 * _HOUR))
    yield Figure("ingest.page_figures", spent, None, f"{unit}, 49 hours", at_most=_PAGE_MS)
    database.close()


def _ms(work: Callable[[], object]) -> float:
    begin = time.perf_counter()
    work()
    return (time.perf_counter() - begin) * 1e3

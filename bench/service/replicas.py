"""Two replicas on PostgreSQL behind HAProxy, and a fleet: what one service does, on two.

The guards connect through the balancer, with the configuration in deploy/ but for TLS. People ask
both replicas in turn, about robots of either. At last one replica is killed.
"""

import signal
import time
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from shutil import which

import pg8000.dbapi

from bench.common.process_usage import processor_ns, resident_mb
from bench.common.testbed import ROOT, ReportProgress, Testbed, running
from bench.common.workload import FLEET_SECONDS, FLEETS, SETTLE_SECONDS
from bench.service.fleet import (
    Fleet,
    create_tokens,
    event_figures,
    losses,
    people_figures,
    run_fleet,
)
from bench.service.postgresql_server import postgresql_server
from bench.service.service_process import ServiceProcess
from figures.figure import Figure
from rtron.demos.runtime.isolation import free_port
from rtron.service.server.database_setup import add_first_admin
from rtron.service.store.database import Database

_CONNECT_S = 120.0
_BACK_S = 40.0
_TLS = ' ssl crt "${RTRON_CERTIFICATE}"'


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give the figures of each fleet."""
    with postgresql_server(testbed.folder / "postgresql") as (pid, port):
        for size in FLEETS:
            yield from _fleet_figures(testbed, pid, port, size, progress)


def _fleet_figures(
    testbed: Testbed, database_pid: int, port: int, size: int, progress: ReportProgress
) -> Iterator[Figure]:
    name = f"replicas.{size}"
    url = _new_database(port, f"fleet{size}")
    tokens = create_tokens(url, size)
    with ExitStack() as stack:
        services = [stack.enter_context(_replica(testbed, url, f"{name}.{n}")) for n in (1, 2)]
        balancer_pid, balanced = stack.enter_context(_balancer(testbed, services))
        fleet = stack.enter_context(run_fleet(testbed, balanced, tokens))
        progress(f"{size} guards connect")
        took = fleet.wait_connected(time.monotonic(), _CONNECT_S)
        yield Figure(f"{name}.connect", took, None, "s until all are connected")
        progress(f"{size} guards alone")
        processes = {
            "first": lambda: [services[0].pid],
            "second": lambda: [services[1].pid],
            "database": lambda: _children(database_pid),
            "balancer": lambda: [balancer_pid],
        }
        yield from _load_figures(processes, fleet, name)
        for service, which_one in zip(services, processes, strict=False):
            yield Figure(f"{name}.{which_one}.memory", resident_mb(service.pid), None, "MB")
        progress(f"{size} guards and people")
        yield from people_figures(services, fleet, name, size)
        progress(f"{size} guards after a kill")
        yield from _kill_figures(services[0], fleet, name, size, url)


def _load_figures(
    processes: Mapping[str, Callable[[], Collection[int]]], fleet: Fleet, name: str
) -> Iterator[Figure]:
    time.sleep(SETTLE_SECONDS)
    fleet.report()
    before = {each: _times(pids()) for each, pids in processes.items()}
    begin = time.monotonic_ns()
    time.sleep(FLEET_SECONDS)
    took = time.monotonic_ns() - begin
    for each, pids in processes.items():
        after = _times(pids())
        used = sum(used - before[each].get(pid, 0) for pid, used in after.items())
        yield Figure(f"{name}.{each}.processor", 100 * used / took, None, "% of a core")
    report = fleet.report()
    yield from event_figures(name, report)
    yield Figure(f"{name}.waiting", report["waiting"], None, "events not stored at the end")
    yield Figure(f"{name}.dropped", sum(report["failures"].values()), None, "guards", at_most=0)


def _kill_figures(
    service: ServiceProcess, fleet: Fleet, name: str, size: int, url: str
) -> Iterator[Figure]:
    """Kill a replica; give when all guards are connected to the other one."""
    fleet.report()
    service.stop(signal.SIGKILL)
    killed = time.monotonic()
    back = fleet.wait_back(killed, _BACK_S)
    yield Figure(f"{name}.back", back, None, f"s after the kill, all of {size}", at_most=5)
    acknowledged = fleet.report()["acknowledged"]
    lost, doubled = losses(url, acknowledged)
    unit = f"of {sum(acknowledged.values()):,} acknowledged events"
    yield Figure(f"{name}.lost", lost, None, unit, at_most=0)
    yield Figure(f"{name}.doubled", doubled, None, unit, at_most=0)


@contextmanager
def _replica(testbed: Testbed, url: str, name: str) -> Iterator[ServiceProcess]:
    folder = testbed.folder / name
    folder.mkdir()
    options = "--log-level", "warning", "--proxy", "127.0.0.1"
    with ServiceProcess(folder, url, *options, token_name=name) as service:
        yield service


@contextmanager
def _balancer(testbed: Testbed, services: list[ServiceProcess]) -> Iterator[tuple[int, int]]:
    """Run HAProxy before the services; give its process and port."""
    port = free_port()
    configuration = (ROOT / "deploy" / "haproxy.cfg").read_text()
    assert _TLS in configuration
    path = testbed.folder / f"haproxy{port}.cfg"
    path.write_text(configuration.replace(_TLS, ""))
    first, second = (f"127.0.0.1:{service.port}" for service in services)
    environ = {"RTRON_LISTEN": f"127.0.0.1:{port}", "RTRON_FIRST": first, "RTRON_SECOND": second}
    program = which("haproxy", path="/usr/sbin:/usr/bin") or "haproxy"
    own = Testbed({**testbed.environ, **environ}, testbed.folder)
    with running(own, [program, "-db", "-f", str(path)]) as process:
        yield process.pid, port


def _new_database(port: int, name: str) -> str:
    connection = pg8000.dbapi.connect("postgres", "127.0.0.1", "postgres", port)
    connection.autocommit = True
    connection.cursor().execute(f"CREATE DATABASE {name}")
    connection.close()
    url = f"postgresql://postgres@127.0.0.1:{port}/{name}"
    database = Database(url)
    add_first_admin(database, time.time_ns())
    database.close()
    return url


def _children(pid: int) -> list[int]:
    """Return a process and its children."""
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text()
    return [pid, *map(int, children.split())]


def _times(pids: Collection[int]) -> dict[int, int]:
    """Return the processor time of each process that is still there, ns."""
    times = {}
    for pid in pids:
        if Path(f"/proc/{pid}").exists():
            times[pid] = processor_ns(pid)
    return times

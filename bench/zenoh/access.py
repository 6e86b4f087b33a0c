"""What Zenoh's access control costs: a command by the router, beside one from peer to peer.

The peer is what rmw_zenoh does by default: sessions find one another by the router's gossip, and
send by TCP. Between them, as a step of its own, lies the same router without TLS and without rules.
"""

import json
import time
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path

from bench.common.process_usage import processor_ns
from bench.common.testbed import ReportProgress, Testbed, end, python, running, start
from bench.common.workload import HOP_SECONDS, RUNS
from figures.figure import Figure
from rtron.demos.runtime.isolation import free_port
from rtron.security.zenoh.configuration import ZenohRouter
from rtron.sources.graph_json import graph_to_json
from rtron.vocabulary import Direction, Endpoint, InteractionGraph, Node
from rtron.workflows.secure import SecureRequest, secure

RATE = 200
TWIST, IMAGE = 60, 1_000_000
IMAGE_RATE = 30
_ROUTED = ("routed", "secured")
_NODES = 40
"""How many more processes the app has, whose rules the router holds."""
_KEY = "0/rtron/cmd_vel/out/geometry_msgs::msg::dds_::Twist_/RIHS01_0"
_PLAN = """\
ros: 2
grcn:
  - topic: /cmd_vel
    mode: enforce
    policy: Block
    flows: [{name: nav, publisher: /nav}]
    successors: [/base]
"""


@dataclass(frozen=True, slots=True)
class Run:
    """Latencies, ns, messages that did not come, and what the router used, % of a core."""

    latencies: list[int]
    lost: int
    router: float


@dataclass(frozen=True, slots=True)
class Way:
    """How a message goes from the guard to the base: the files of three sessions."""

    router: Path
    sender: Path
    receiver: Path


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give latency and the router's processor time."""
    ways = {"direct": _direct(testbed), "routed": _routed(testbed), "secured": _secured(testbed)}
    for name, size, rate in (("twist", TWIST, RATE), ("image", IMAGE, IMAGE_RATE)):
        runs: dict[str, list[Run]] = {way: [] for way in ways}
        for number in range(RUNS):
            for way, files in ways.items():
                progress(f"{name}, {way}, {number + 1} of {RUNS}")
                runs[way].append(_run(testbed, files, size, rate))
        yield from _figures_of(name, runs)


def _figures_of(name: str, runs: dict[str, list[Run]]) -> Iterator[Figure]:
    for part, place in (("median", 0.5), ("p99", 0.99)):
        values = {way: [_quantile(run, place) for run in of_way] for way, of_way in runs.items()}
        for way in _ROUTED:
            yield Figure.of_runs(f"zenoh.{name}_{way}_{part}", values[way], values["direct"], "us")
    for way in _ROUTED:
        use = [run.router for run in runs[way]]
        yield Figure.of_runs(f"zenoh.{name}_{way}_router", use, (), "% of a core")
    for way in _ROUTED:
        lost, direct = (sum(run.lost for run in runs[each]) for each in (way, "direct"))
        yield Figure(f"zenoh.{name}_{way}_lost", lost, direct, "messages")


def _quantile(run: Run, place: float) -> float:
    ordered = sorted(run.latencies)
    return ordered[int(place * (len(ordered) - 1))] / 1000


def _run(testbed: Testbed, way: Way, size: int, rate: int) -> Run:
    count = rate * HOP_SECONDS
    receiving = python("bench.zenoh.node", "receive", str(way.receiver), _KEY, str(count))
    sizes = map(str, (count, rate, size))
    with running(testbed, python("bench.zenoh.node", "route", str(way.router))) as router:
        receiver = start(testbed, receiving, piped=True)
        sending = python("bench.zenoh.node", "send", str(way.sender), _KEY, *sizes)
        began = time.monotonic()
        before = processor_ns(router.pid)
        with running(testbed, sending):
            assert receiver.stdout
            latencies = json.loads(receiver.stdout.readline())
        used = processor_ns(router.pid) - before
        end(receiver)
    if not latencies:
        raise RuntimeError("no message came")
    return Run(latencies, count - len(latencies), 100 * used / 1e9 / (time.monotonic() - began))


def _direct(testbed: Testbed) -> Way:
    """Return sessions as rmw_zenoh configures them."""
    router, sessions = _plain("peer")
    sessions["listen"] = {"endpoints": ["tcp/localhost:0"]}
    return _written(testbed, "direct", router, sessions)


def _routed(testbed: Testbed) -> Way:
    return _written(testbed, "routed", *_plain("client"))


def _plain(mode: str) -> tuple[dict, dict]:
    address = f"tcp/localhost:{free_port()}"
    common = {
        "scouting": {"multicast": {"enabled": False}},
        "timestamping": {"enabled": True},
        "transport": {"shared_memory": {"enabled": False}},
    }
    router = {"mode": "router", "listen": {"endpoints": [address]}, **common}
    session = {"mode": mode, "connect": {"endpoints": [address], "timeout_ms": -1}, **common}
    return router, session


def _written(testbed: Testbed, name: str, router: dict, session: dict) -> Way:
    files = [testbed.folder / f"{name}_{part}.json5" for part in ("router", "session")]
    for path, config in zip(files, (router, session), strict=True):
        path.write_text(json.dumps(config))
    return Way(files[0], files[1], files[1])


def _secured(testbed: Testbed) -> Way:
    """Return what `rtron secure --zenoh` writes for an app of many processes."""
    folder = testbed.folder / "zenoh"
    folder.mkdir()
    names = ("/nav", "/base", *(f"/node_{number}" for number in range(_NODES)))
    sides = (("/nav", Direction.PUBLISH), ("/base", Direction.SUBSCRIBE))
    graph = InteractionGraph(
        app="bench",
        ros=2,
        nodes=tuple(Node(name=name) for name in names),
        endpoints=tuple(Endpoint(node=n, topic="/cmd_vel", direction=side) for n, side in sides),
    )
    (folder / "graph.json").write_text(json.dumps(graph_to_json(graph)))
    (folder / "rtron.yaml").write_text(_PLAN)
    keystore = folder / "keystore"
    request = SecureRequest(
        plan=folder / "rtron.yaml",
        graph=folder / "graph.json",
        keystore=keystore,
        now=datetime.now(timezone.utc),
        domain=0,
        zenoh=ZenohRouter(port=free_port()),
    )
    secure(request, write=True)
    sessions = (keystore / f"enclaves/{name}/zenoh.json5" for name in ("rtron_guard", "base"))
    return Way(keystore / "zenoh/router.json5", *sessions)

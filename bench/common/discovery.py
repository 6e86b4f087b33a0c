"""How long risk discovery takes: the Home app, and a fleet of them with a million endpoints."""

import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from itertools import count, islice
from statistics import median

from bench.common.testbed import ROOT, ReportProgress, Testbed

sys.path.append(str(ROOT / "tests" / "fixtures"))

from app_graphs import HOME

from bench.common.workload import ENDPOINTS
from figures.figure import Figure
from rtron.risks import discover_risks
from rtron.vocabulary import Endpoint, InteractionGraph

PUBLISHED_S = 3.121 + 3.199 + 1.927
"""The paper's processing time for Home, s: GR, RSR and MSR, on the authors' machine."""
_REPEATS = 25
_PARTS = (4, 2, 1)


def figures(_testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give the time for Home, for the fleet, and how it grows with the endpoints."""
    home = HOME
    progress("Home")
    ours = median(seconds(_fresh(home)) for _ in range(_REPEATS))
    yield Figure("discovery.home", ours, PUBLISHED_S, "s (peer: as published)")
    times = []
    for part in _PARTS:
        size = ENDPOINTS // part
        progress(f"{size:,} endpoints")
        times.append(seconds(fleet(home, size)))
        yield Figure(f"discovery.endpoints_{size}", times[-1], None, "s")
    growth = times[-1] / times[0]
    yield Figure("discovery.growth", growth, _PARTS[0], "times (peer: linear)", ratio_at_most=1.5)


def seconds(graph: InteractionGraph) -> float:
    """Return how long discovery takes, s."""
    start = time.perf_counter()
    discover_risks(graph)
    return time.perf_counter() - start


def fleet(app: InteractionGraph, size: int) -> InteractionGraph:
    """Return many copies of an app, each in a namespace of its own, with `size` endpoints."""
    copies = size // len(app.endpoints) + 1
    nodes = (
        replace(node, name=f"/r{copy}{node.name}") for copy in range(copies) for node in app.nodes
    )
    endpoints = (_moved(end, copy) for copy in count() for end in app.endpoints)
    return InteractionGraph(
        app="fleet", nodes=tuple(nodes), endpoints=tuple(islice(endpoints, size))
    )


def _moved(endpoint: Endpoint, copy: int) -> Endpoint:
    return replace(endpoint, node=f"/r{copy}{endpoint.node}", topic=f"/r{copy}{endpoint.topic}")


def _fresh(graph: InteractionGraph) -> InteractionGraph:
    """Return the graph without the indexes that an earlier use left."""
    return replace(graph)

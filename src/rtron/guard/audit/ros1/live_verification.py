"""Asking what `verify` compares, once and from outside: without joining the graph."""

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from concurrent.futures import TimeoutError as LateError
from contextlib import suppress
from functools import partial
from typing import TypeVar

from rtron.errors import RTronError, SourceError
from rtron.guard.audit.common.verification import Verification
from rtron.guard.audit.ros1.bus_info import BusConnection, parse_bus_info
from rtron.guard.audit.ros1.expected_graph import ExpectedGraph
from rtron.guard.audit.ros1.registrations import guarded_subscribers, parse_registrations
from rtron.guard.audit.ros1.verification import ApiAnswers, queried_nodes, verify
from rtron.vocabulary import Plan
from rtron.wire.ros1.xmlrpc import ros_call

_T = TypeVar("_T")
_K = TypeVar("_K")
_CALLER = "/rtron_verify"
_THREADS = 32
_HELP = "is the app running? name its master with --master or ROS_MASTER_URI"


def verify_live(plan: Plan, master: str, timeout: float) -> Verification:
    """Audit the app that is running; each call may take `timeout` seconds.

    SourceError if the master does not answer, or not as a master.
    """
    expected = ExpectedGraph(plan)
    try:
        state = ros_call(master, "getSystemState", _CALLER, timeout=timeout)
        listed = parse_registrations(state, expected.topics)
    except RTronError as error:
        raise SourceError(f"nothing can be verified at {master}: {error}", help=_HELP) from error
    own = expected.guard_nodes
    uris = _query_all(queried_nodes(expected, listed), partial(_uri, master, timeout), timeout)
    guarded = [(node, uris[node]) for node in guarded_subscribers(listed, expected) if node in uris]
    links = _query_all(guarded, partial(_links, timeout), timeout)
    pids = _query_all([(n, uris[n]) for n in own if n in uris], partial(_pid, timeout), timeout)
    answers = ApiAnswers(
        state=listed,
        services=tuple(_services(state[2])),
        uris=uris,
        connections={node: found for (node, _), found in links.items()},
        pids={node: pid for (node, _), pid in pids.items()},
    )
    return verify(plan, answers)


def _query_all(keys: Iterable[_K], query: Callable[[_K], _T], timeout: float) -> dict[_K, _T]:
    """Return the answers of those who give one in time."""
    pool = ThreadPoolExecutor(_THREADS)
    found = {key: pool.submit(query, key) for key in keys}
    answers = {}
    for key, future in found.items():
        with suppress(RTronError, LateError, ValueError):
            answers[key] = future.result(2 * timeout)
    pool.shutdown(wait=False, cancel_futures=True)
    return answers


def _uri(master: str, timeout: float, node: str) -> str:
    uri = ros_call(master, "lookupNode", _CALLER, node, timeout=timeout)
    if not isinstance(uri, str):
        raise SourceError(f"{node} has no address")
    return uri


def _links(timeout: float, node: tuple[str, str]) -> frozenset[BusConnection]:
    return parse_bus_info(ros_call(node[1], "getBusInfo", _CALLER, timeout=timeout))


def _pid(timeout: float, node: tuple[str, str]) -> int:
    pid = ros_call(node[1], "getPid", _CALLER, timeout=timeout)
    if not isinstance(pid, int):
        raise SourceError(f"{node[0]} has no process id")
    return pid


def _services(side: object) -> Iterator[tuple[str, str]]:
    for row in side if isinstance(side, list) else []:
        if isinstance(row, list) and len(row) == 2 and isinstance(row[1], list):  # noqa: PLR2004
            service, nodes = row
            named = [node for node in nodes if isinstance(node, str)]
            yield from ((service, node) for node in named if isinstance(service, str))

"""Asking what `verify` compares, once and from outside: without joining the graph."""

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from concurrent.futures import TimeoutError as LateError
from contextlib import suppress
from functools import partial
from typing import TypeVar

from rtron.errors import RTronError, SourceError
from rtron.guard.audit.ros1.bus_info import Link, links_in
from rtron.guard.audit.ros1.expected_graph import Expectations
from rtron.guard.audit.ros1.registrations import listeners, registered
from rtron.guard.audit.ros1.verification import Answers, Verification, asked_nodes, verify
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
    expected = Expectations(plan)
    try:
        state = ros_call(master, "getSystemState", _CALLER, timeout=timeout)
        listed = registered(state, expected.topics)
    except RTronError as error:
        raise SourceError(f"nothing can be verified at {master}: {error}", help=_HELP) from error
    own = expected.own
    uris = _each(asked_nodes(expected, listed), partial(_uri, master, timeout), timeout)
    guarded = [(node, uris[node]) for node in listeners(listed, expected) if node in uris]
    links = _each(guarded, partial(_links, timeout), timeout)
    pids = _each([(n, uris[n]) for n in own if n in uris], partial(_pid, timeout), timeout)
    answers = Answers(
        state=listed,
        services=tuple(_services(state[2])),
        uris=uris,
        links={node: found for (node, _), found in links.items()},
        pids={node: pid for (node, _), pid in pids.items()},
    )
    return verify(plan, answers)


def _each(keys: Iterable[_K], ask: Callable[[_K], _T], timeout: float) -> dict[_K, _T]:
    """Return the answers of those who give one in time."""
    pool = ThreadPoolExecutor(_THREADS)
    found = {key: pool.submit(ask, key) for key in keys}
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


def _links(timeout: float, node: tuple[str, str]) -> frozenset[Link]:
    return links_in(ros_call(node[1], "getBusInfo", _CALLER, timeout=timeout))


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

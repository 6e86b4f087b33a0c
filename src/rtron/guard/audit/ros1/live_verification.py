"""Asking what `verify` compares, once and from outside: without joining the graph."""

from collections.abc import Callable, Collection, Mapping
from concurrent.futures import ThreadPoolExecutor
from concurrent.futures import TimeoutError as LateError
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import TypeVar

from rtron.errors import RTronError, SourceError, WireError
from rtron.guard.audit.ros1.expected_graph import ExpectedGraph
from rtron.guard.audit.ros1.foreign_connections import parse_connections
from rtron.guard.audit.ros1.registrations import guarded_subscribers, select_registrations
from rtron.guard.audit.ros1.verification import ApiAnswers, pinged_nodes, queried_nodes, verify
from rtron.guard.cell.access import WATCH, CellAccess, CellNetwork
from rtron.guard.cell.cell_report import verify_cells
from rtron.guard.master_proxy.master_file import find_private_master
from rtron.guard.transport.ros1.celled_transport import PRIVATE_MASTER
from rtron.vocabulary import Plan
from rtron.vocabulary.verification import Verification
from rtron.wire.ros1.network import HOST_NETWORK, Network
from rtron.wire.ros1.ros_api import (
    parse_bus_peers,
    query_bus_info,
    query_node_uri,
    query_parent_id,
    query_process_id,
    query_system_state,
)
from rtron.wire.ros1.xmlrpc import RefusalError

_T = TypeVar("_T")
_CALLER = "/rtron_verify"
_THREADS = 32
_HELP = "is the app running? name its master with --master or ROS_MASTER_URI"


def verify_live(plan: Plan, address: str, timeout: float) -> Verification:
    """Audit the app that is running, and its cells; each call may take `timeout` seconds.

    SourceError if the master does not answer, or not as a master.
    """
    outside = _verify_at(plan, find_private_master(address), timeout)
    return verify_cells(plan, address, outside, partial(_verify_inside, plan, timeout))


def _verify_inside(plan: Plan, timeout: float, access: CellAccess) -> Verification:
    """Compare the plan with what is in a cell; only the paths are told, for not all is inside."""
    connection, _, sockets = access.watch(WATCH)
    network = CellNetwork(access, sockets)
    try:
        inside = _verify_at(plan, PRIVATE_MASTER, timeout, network)
        return replace(inside, problems=(), unguarded=())
    finally:
        connection.close()
        network.close()


def _verify_at(
    plan: Plan, master: str, timeout: float, network: Network = HOST_NETWORK
) -> Verification:
    return verify(plan, _query_app(ExpectedGraph(plan), master, timeout, network))


def _query_app(
    expected: ExpectedGraph, master: str, timeout: float, network: Network
) -> ApiAnswers:
    try:
        state = query_system_state(master, _CALLER, timeout, network)
    except RTronError as error:
        raise SourceError(f"nothing can be verified at {master}: {error}", help=_HELP) from error
    listed = select_registrations(state, expected.topics)
    uris = _query_all(
        {node: node for node in queried_nodes(expected, listed)},
        lambda node: query_node_uri(master, _CALLER, node, timeout, network),
        timeout,
    )
    guards = _select(uris, expected.guard_nodes)
    peers = _query_all(
        guards, lambda uri: parse_bus_peers(query_bus_info(uri, _CALLER, timeout, network)), timeout
    )
    return ApiAnswers(
        state=listed,
        nodes=frozenset(state.nodes()),
        guard_peers=frozenset().union(*peers.values()),
        services=state.services,
        uris=uris,
        connections=_query_all(
            _select(uris, guarded_subscribers(listed, expected)),
            lambda uri: parse_connections(query_bus_info(uri, _CALLER, timeout, network)),
            timeout,
        ),
        pids=_query_all(
            _select(uris, pinged_nodes(expected, listed)),
            lambda uri: query_process_id(uri, _CALLER, timeout, network),
            timeout,
        ),
        guard_parents=_query_all(guards, lambda uri: _parent_id(uri, timeout, network), timeout),
    )


def _parent_id(uri: str, timeout: float, network: Network) -> int:
    """Return the id of a node's parent process, 0 if the node answers something else."""
    try:
        return query_parent_id(uri, _CALLER, timeout, network)
    except (RefusalError, WireError):
        return 0


def _select(uris: Mapping[str, str], nodes: Collection[str]) -> dict[str, str]:
    return {node: uri for node, uri in uris.items() if node in nodes}


def _query_all(
    arguments: Mapping[str, str], query: Callable[[str], _T], timeout: float
) -> dict[str, _T]:
    """Ask with the argument of each node; return the answers of those who give one in time."""
    pool = ThreadPoolExecutor(_THREADS)
    futures = {node: pool.submit(query, argument) for node, argument in arguments.items()}
    answers = {}
    for node, future in futures.items():
        with suppress(RTronError, LateError, ValueError):  # no answer: its paths are unknown
            answers[node] = future.result(2 * timeout)
    pool.shutdown(wait=False, cancel_futures=True)
    return answers

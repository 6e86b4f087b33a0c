"""Latched topics of ROS 2 whose publisher sends once, or when something changes, not ever again."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import TypeAlias

from rtron.sources.code import ir
from rtron.sources.code.endpoint_calls import ENDPOINT_CALLS
from rtron.sources.code.ir.references import ir_nodes
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.static.common.node_sources import CPP, node_sources
from rtron.sources.workspace import Workspace
from rtron.vocabulary import (
    Direction,
    Durability,
    Endpoint,
    InteractionGraph,
    Resolution,
    WiringFact,
    WiringFactKind,
)

_ON_REQUEST = frozenset(
    {
        *("create_service", "ActionServer", "create_server", "create_action_server"),
        "add_on_set_parameters_callback",
    }
)
"""What they are given is called when somebody asks for it."""
_WRAPPERS = frozenset({"bind", "partial", "function", "move", "forward"})
_MAKING = frozenset({"__init__", "main"})
_STARTED = frozenset({"on_configure", "on_activate", "on_deactivate", "on_cleanup", "on_shutdown"})
"""Methods that a library calls when a node changes its state."""
_MAKERS = ENDPOINT_CALLS | {"create_lifecycle_publisher"}
_Key: TypeAlias = tuple[str, int, str]


@dataclass(frozen=True, slots=True)
class _NodeSource:
    """What the source of a node tells about all of its publishers, each by its plain name.

    `made` are the variables that get an endpoint, by its place, `sent` what is published by,
    `handed_on` what loops use, what others get and what is renamed, `users` the functions that
    mention a name, `started` what anybody calls.
    """

    made: Mapping[tuple[str, int], set[str]]
    sent: set[str]
    handed_on: set[str]
    users: Mapping[str, set[str]]
    started: frozenset[str]


def with_state_publishers(graph: InteractionGraph, workspace: Workspace) -> InteractionGraph:
    """Return a graph with a fact for each topic that a node latches and does not repeat.

    Only latched topics with a reader that asks for no history are looked at.
    """
    sources = WorkspaceSources(workspace)
    nodes = {node.name: node for node in graph.nodes}

    @cache
    def source_of(name: str) -> _NodeSource:
        paths = node_sources(nodes[name], workspace) if name in nodes else {}
        return _node_source([sources.lowered_unit(path, _language(path)) for path in paths])

    candidates = [end for end in graph.endpoints if _is_candidate(graph, end)]
    facts = [fact for end in candidates for fact in _facts(end, source_of(end.node))]
    return replace(graph, wiring=(*graph.wiring, *facts))


def _language(path: Path) -> ir.SourceLanguage:
    return ir.SourceLanguage.CPP if path.suffix in CPP else ir.SourceLanguage.PYTHON


def _is_candidate(graph: InteractionGraph, end: Endpoint) -> bool:
    """Return whether source latches a topic that somebody reads without its history."""
    is_latched = end.qos is not None and end.qos.durability is Durability.TRANSIENT_LOCAL
    if end.direction is not Direction.PUBLISH or not is_latched or end.implicit:
        return False
    readers = (each.qos for each in graph.subscribers(end.topic) if each.node != end.node)
    loses = any(qos is not None and qos.durability is Durability.VOLATILE for qos in readers)
    return loses and end.resolution is not Resolution.MODEL and bool(end.evidence)


def _facts(end: Endpoint, source: _NodeSource) -> Iterator[WiringFact]:
    names = set[str]().union(
        *(source.made.get((each.file, each.line), set()) for each in end.evidence)
    )
    if len(names) != 1:
        return
    publisher = names.pop()
    if publisher in source.sent and not _is_repeated(source, publisher):
        kind = WiringFactKind.STATE_PUBLISHER
        yield WiringFact(kind=kind, subject=end.topic, value=end.node, evidence=end.evidence)


def _node_source(units: Sequence[ir.Unit]) -> _NodeSource:
    nodes = [node for unit in units for node in ir_nodes(_parts(unit))]
    functions = [node for node in nodes if isinstance(node, ir.Function)]
    named = [function for function in functions if function.name[:1] not in {"", "<"}]
    mentions = {node.key: _mentions((node.body, node.initialisers)) for node in named}
    loops = (_mentions(node.body) for node in nodes if isinstance(node, ir.While))
    calls = [node for node in nodes if isinstance(node, ir.Call)]
    passed_on = (_mentions((call.args, call.keywords)) for call in calls if _keeps(call))
    values = (node.value for node in nodes if isinstance(node, (ir.Assign, ir.Declare, ir.Return)))
    return _NodeSource(
        made=_made(units),
        sent=set().union(*map(_sent, calls)),
        handed_on=set().union(
            *loops, *passed_on, (_name(each) for each in values if each is not None)
        ),
        users=_users(named, mentions),
        started=_STARTED.union(*mentions.values()),
    )


def _made(units: Iterable[ir.Unit]) -> Mapping[tuple[str, int], set[str]]:
    """Return the variables that get an endpoint, by the file and line that make it."""
    found: dict[tuple[str, int], set[str]] = defaultdict(set)
    for unit in units:
        for name, value in _given(unit):
            for node in ir_nodes(value):
                if isinstance(node, ir.Call) and _name(node.function) in _MAKERS:
                    found[unit.file, node.line].add(name)
    return found


def _given(unit: ir.Unit) -> Iterator[tuple[str, object]]:
    """Yield the variables of a file that get a value, with it."""
    for node in ir_nodes(_parts(unit)):
        if isinstance(node, ir.Assign):
            yield from ((_name(target), node.value) for target in node.targets)
        elif isinstance(node, ir.Declare):
            yield node.name, node.value
        elif isinstance(node, ir.Function):
            yield from node.initialisers


def _parts(unit: ir.Unit) -> tuple[object, ...]:
    return (unit.body, unit.functions, unit.classes)


def _name(expression: ir.Expr) -> str:
    """Return the last part of a name: `state_` of `this->state_`."""
    if isinstance(expression, ir.Attr):
        return expression.name
    return expression.id.rpartition("::")[2] if isinstance(expression, ir.Name) else ""


def _mentions(part: object) -> set[str]:
    """Return the plain names of all variables and functions in a part of the code."""
    return {_name(node) for node in ir_nodes(part) if isinstance(node, (ir.Attr, ir.Name))}


def _sent(call: ir.Call) -> set[str]:
    """Return the names of what a call may publish by."""
    if not isinstance(call.function, ir.Attr) or call.function.name != "publish":
        return set()
    return _mentions(call.function.owner)


def _is_repeated(source: _NodeSource, publisher: str) -> bool:
    """Return whether a loop, a timer, a thread or another topic may have it sent again.

    So may somebody whom the publisher is handed to, or a library that calls a method by its name.
    """
    users, pending = {publisher}, [publisher]
    while pending:
        found = source.users.get(pending.pop(), set()) - users
        users |= found
        pending.extend(found)
    return bool(users & source.handed_on) or not users - {publisher} <= source.started


def _users(
    functions: Iterable[ir.Function], mentions: Mapping[_Key, set[str]]
) -> Mapping[str, set[str]]:
    """Return the functions that mention each name; constructors apart."""
    users: dict[str, set[str]] = defaultdict(set)
    for function in functions:
        *owner, name = function.name.split("::")
        if name not in _MAKING and name not in owner[-1:]:
            for word in mentions[function.key]:
                users[word].add(name)
    return users


def _keeps(call: ir.Call) -> bool:
    """Return whether what is called may call what it is given at any time."""
    return _name(call.function) not in _ON_REQUEST | _WRAPPERS

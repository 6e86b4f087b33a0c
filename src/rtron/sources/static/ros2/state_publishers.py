"""Latched topics of ROS 2 whose publisher sends once, or when something changes, not ever again."""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

from rtron.sources.code.endpoint_calls import ENDPOINT_CALLS
from rtron.sources.code.ir import (
    Assign,
    Attr,
    Call,
    Declare,
    Expr,
    Function,
    Name,
    Return,
    SourceLanguage,
    Unit,
    While,
)
from rtron.sources.code.ir.references import ir_nodes
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.static.common.node_sources import CPP, node_sources
from rtron.sources.workspace import Workspace
from rtron.vocabulary import (
    Direction,
    Durability,
    Endpoint,
    Evidence,
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
_UnitsOf: TypeAlias = Callable[[str], list[Unit]]


def with_state_publishers(graph: InteractionGraph, workspace: Workspace) -> InteractionGraph:
    """Return a graph with a fact for each topic that a node latches and does not repeat.

    Only latched topics with a reader that asks for no history are looked at.
    """
    sources = WorkspaceSources(workspace)
    nodes = {node.name: node for node in graph.nodes}

    def units_of(node: str) -> list[Unit]:
        paths = node_sources(nodes[node], workspace) if node in nodes else {}
        return [sources.lowered_unit(path, _language(path)) for path in paths]

    candidates = [end for end in graph.endpoints if _is_candidate(graph, end)]
    facts = [fact for end in candidates for fact in _facts(end, units_of)]
    return replace(graph, wiring=(*graph.wiring, *facts))


def _language(path: Path) -> SourceLanguage:
    return SourceLanguage.CPP if path.suffix in CPP else SourceLanguage.PYTHON


def _is_candidate(graph: InteractionGraph, end: Endpoint) -> bool:
    """Return whether source latches a topic that somebody reads without its history."""
    is_latched = end.qos is not None and end.qos.durability is Durability.TRANSIENT_LOCAL
    if end.direction is not Direction.PUBLISH or not is_latched or end.implicit:
        return False
    readers = (each.qos for each in graph.subscribers(end.topic) if each.node != end.node)
    loses = any(qos is not None and qos.durability is Durability.VOLATILE for qos in readers)
    return loses and end.resolution is not Resolution.MODEL and bool(end.evidence)


def _facts(end: Endpoint, units_of: _UnitsOf) -> Iterator[WiringFact]:
    units = units_of(end.node)
    names = {name for unit in units for name in _publishers_at(unit, end.evidence)}
    if len(names) != 1:
        return
    publisher = names.pop()
    nodes = [node for unit in units for node in ir_nodes(_parts(unit))]
    if _is_published(nodes, publisher) and not _is_repeated(nodes, publisher):
        kind = WiringFactKind.STATE_PUBLISHER
        yield WiringFact(kind=kind, subject=end.topic, value=end.node, evidence=end.evidence)


def _publishers_at(unit: Unit, places: tuple[Evidence, ...]) -> Iterator[str]:
    """Yield the variables that get what is made at some places of a file."""
    lines = {place.line for place in places if place.file == unit.file}
    for name, value in _given(unit) if lines else ():
        calls = (node for node in ir_nodes(value) if isinstance(node, Call))
        if any(call.line in lines and _name(call.function) in _MAKERS for call in calls):
            yield name


def _given(unit: Unit) -> Iterator[tuple[str, object]]:
    """Yield the variables of a file that get a value, with it."""
    for node in ir_nodes(_parts(unit)):
        if isinstance(node, Assign):
            yield from ((_name(target), node.value) for target in node.targets)
        elif isinstance(node, Declare):
            yield node.name, node.value
        elif isinstance(node, Function):
            yield from node.initialisers


def _parts(unit: Unit) -> tuple[object, ...]:
    return (unit.body, unit.functions, unit.classes)


def _name(expression: Expr) -> str:
    """Return the last part of a name: `state_` of `this->state_`."""
    if isinstance(expression, Attr):
        return expression.name
    return expression.id.rpartition("::")[2] if isinstance(expression, Name) else ""


def _mentions(part: object) -> set[str]:
    """Return the plain names of all variables and functions in a part of the code."""
    return {_name(node) for node in ir_nodes(part) if isinstance(node, (Attr, Name))}


def _is_published(nodes: Iterable[object], publisher: str) -> bool:
    calls = (node.function for node in nodes if isinstance(node, Call))
    sends = (each for each in calls if isinstance(each, Attr) and each.name == "publish")
    return any(publisher in _mentions(each.owner) for each in sends)


def _is_repeated(nodes: Sequence[object], publisher: str) -> bool:
    """Return whether a loop, a timer, a thread or another topic may have it sent again.

    So may somebody whom the publisher is handed to, or a library that calls a method by its name.
    """
    functions = (node for node in nodes if isinstance(node, Function))
    named = [function for function in functions if function.name[:1] not in {"", "<"}]
    mentions = {node.key: _mentions((node.body, node.initialisers)) for node in named}
    users = _users(named, mentions, publisher)
    loops = any(users & _mentions(node.body) for node in nodes if isinstance(node, While))
    calls = (node for node in nodes if isinstance(node, Call))
    handed_on = any(users & _mentions((each.args, each.keywords)) for each in calls if _keeps(each))
    given = (node.value for node in nodes if isinstance(node, (Assign, Declare, Return)))
    renamed = any(value is not None and _name(value) in users for value in given)
    started = _STARTED.union(*mentions.values())
    return loops or handed_on or renamed or not users - {publisher} <= started


def _users(
    functions: Iterable[Function], mentions: Mapping[_Key, set[str]], publisher: str
) -> set[str]:
    """Return a publisher and the functions that may use it, by others too; constructors apart."""
    by_mention: dict[str, set[str]] = defaultdict(set)
    for function in functions:
        *owner, name = function.name.split("::")
        if name not in _MAKING and name not in owner[-1:]:
            for word in mentions[function.key]:
                by_mention[word].add(name)
    users, pending = {publisher}, [publisher]
    while pending:
        found = by_mention[pending.pop()] - users
        users |= found
        pending.extend(found)
    return users


def _keeps(call: Call) -> bool:
    """Return whether what is called may call what it is given at any time."""
    return _name(call.function) not in _ON_REQUEST | _WRAPPERS

"""The plain names that a function calls and writes, found once and kept."""

from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass
from functools import wraps
from typing import Any, TypeAlias, TypeVar

from rtron.sources.code.ir import (
    Assign,
    AssignExpr,
    Attr,
    Break,
    Call,
    Continue,
    Declare,
    Delete,
    Expr,
    Function,
    Index,
    Name,
    New,
    Return,
    Stmt,
    TypeRef,
    Yield,
)

_ADDING_METHODS = frozenset(
    ["push_back", "emplace_back", "insert", "append", "extend", "add", "update"]
)


_BINDING_CALLS = frozenset({"bind", "thread", "async", "invoke", "call_once", "function"})
_NAMING_NODES = (Call, Declare, New, TypeRef)
_EFFECTFUL_NODES = (Assign, AssignExpr, Break, Call, Continue, Delete, New, Return, Yield)
_HARMLESS_CALLS = frozenset(
    {"c_str", "str", "what", "to_string", "get_logger", "get_name", "string"}
)
_SLOTS: dict[type, tuple[str, ...] | None] = {}
_PLAIN = (str, int, bool, str | None, int | None, str | int | float | bool | bytes | None)
MAX_CACHED = 50_000

_T = TypeVar("_T")
_Names: TypeAlias = frozenset[str]


def cache_by_identity(find: Callable[[_T], _Names]) -> Callable[[_T], _Names]:
    """Keep what is found in a part of the IR by its identity: a hash goes through all of it."""
    cache: dict[int, tuple[_T, _Names]] = {}

    @wraps(find)
    def found(part: _T) -> _Names:
        known = cache.get(id(part))
        if known is None:
            if len(cache) >= MAX_CACHED:
                cache.clear()
            known = cache[id(part)] = part, find(part)
        return known[1]

    return found


@cache_by_identity
def called_names(function: Function) -> frozenset[str]:
    """Return the last parts of the names of all that a function calls, makes or hands on."""
    bodies = (function.body or (), tuple(args for _, args in function.initialisers))
    nodes = [node for node in ir_nodes(bodies) if isinstance(node, _NAMING_NODES)]
    words = frozenset(word for node in nodes for word in _called_or_made_names(node))
    return words | _handed_on_names(function, nodes)


def _handed_on_names(function: Function, nodes: list[Any]) -> frozenset[str]:
    """Return what a function of C++ gives variables at first: functions, not its own variables."""
    declared = [node for node in nodes if isinstance(node, Declare)]
    own = {param.name for param in function.params} | {node.name for node in declared}
    given = {node.value.id for node in declared if isinstance(node.value, Name)}
    return frozenset(name.rpartition("::")[2] for name in given - own)


@cache_by_identity
def written_names(function: Function) -> frozenset[str]:
    """Return the members and globals that a function may assign to."""
    local: set[str] = set()
    changed: list[Expr] = []
    for node in ir_nodes(function.body):
        if isinstance(node, Declare):
            local.add(node.name)
        elif isinstance(node, Assign):
            changed.extend(t.owner if isinstance(t, Index) else t for t in node.targets)
        elif isinstance(node, AssignExpr):
            changed.append(node.target)
        elif isinstance(node, Call):
            added = node.function
            if isinstance(added, Attr) and added.name in _ADDING_METHODS:
                changed.append(added.owner)
    names = {target.name for target in changed if isinstance(target, Attr)}
    names |= {target.id for target in changed if isinstance(target, Name)} - local
    return frozenset(names)


@cache_by_identity
def assigned_names(body: tuple[Stmt, ...]) -> frozenset[str]:
    """Return the variables that statements assign to."""
    nodes = [node for node in ir_nodes(body) if isinstance(node, (Assign, AssignExpr))]
    found = (t for n in nodes for t in (n.targets if isinstance(n, Assign) else (n.target,)))
    return frozenset(target.id for target in found if isinstance(target, Name))


@cache_by_identity
def side_effects(body: tuple[Stmt, ...]) -> frozenset[str]:
    """Return what statements may do beside throwing: empty where they leave nothing behind."""
    found = (node for node in ir_nodes(body) if isinstance(node, _EFFECTFUL_NODES))
    return frozenset(type(node).__name__ for node in found if not _is_harmless(node))


def _is_harmless(node: Any) -> bool:  # noqa: ANN401 - any part of the IR
    if isinstance(node, New):
        return "xception" in node.type.name or "error" in node.type.name
    called = set(callee_names(node.function)) if isinstance(node, Call) else set()
    return bool(called) and all(
        name in _HARMLESS_CALLS or "xception" in name or name.endswith("_error") for name in called
    )


def ir_nodes(node: Any) -> Iterator[Any]:  # noqa: ANN401 - any part of the IR
    """Yield a part of the IR and all parts within it."""
    stack = [node]
    while stack:
        current = stack.pop()
        kind = type(current)
        if kind is tuple:
            stack.extend(current)
            continue
        if kind not in _SLOTS:
            _SLOTS[kind] = _node_fields(kind) if is_dataclass(kind) else None
        slots = _SLOTS[kind]
        if slots is not None:
            yield current
            stack.extend([getattr(current, name) for name in slots])


def _node_fields(kind: type) -> tuple[str, ...]:
    """Return the fields of a part of the IR that may hold other parts."""
    return tuple(each.name for each in fields(kind) if each.type not in _PLAIN)


def _called_or_made_names(node: Any) -> Iterator[str]:  # noqa: ANN401 - any part of the IR
    if isinstance(node, Call):
        yield from callee_names(node.function)
        yield from _passed_functions(node)
    elif isinstance(node, (New, TypeRef)):
        name = node.type.name if isinstance(node, New) else node.name
        yield name.rpartition("::")[2]
        yield name


def _passed_functions(call: Call) -> Iterator[str]:
    """Yield the functions of C++ that are handed on to be called later, `&Driver::start`."""
    binds = not _BINDING_CALLS.isdisjoint(callee_names(call.function))
    for given in call.args:
        if isinstance(given, Name) and (binds or "::" in given.id):
            yield given.id.rpartition("::")[2]


def callee_names(function: Any) -> Iterator[str]:  # noqa: ANN401 - any expression
    """Yield the plain name of what a call calls, where that is written."""
    if isinstance(function, Attr):
        yield function.name
    elif isinstance(function, Name):
        yield function.id.rpartition("::")[2]

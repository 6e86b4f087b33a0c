"""The names behind which Python may have a function: what is called need not say what it is."""

from collections.abc import Iterable, Iterator
from typing import Any

from rtron.sources.code.ir import (
    Assign,
    AssignExpr,
    Attr,
    Call,
    Class,
    Comprehension,
    Const,
    Define,
    ForEach,
    Function,
    Import,
    Index,
    Name,
    SequenceExpr,
    Star,
    With,
)
from rtron.sources.code.ir.references import cache_by_identity, ir_nodes

_ADDING_METHODS = {"append", "appendleft", "add", "insert", "setdefault", "update", "extend"}
_DYNAMIC_FUNCTIONS = {
    *("getattr", "globals", "vars", "locals", "__import__", "import_module", "exec", "eval"),
    *("execfile", "run_path", "run_module"),
}


@cache_by_identity
def mentioned_names(function: Function) -> frozenset[str]:
    """Return the variables and members that a function mentions, also in its defaults."""
    defaults = tuple(param.default for param in function.params if param.default is not None)
    return frozenset(_names((function.body, defaults)))


@cache_by_identity
def callees(function: Function) -> frozenset[str]:
    """Return the names in what a function calls."""
    return frozenset(name for node in ir_nodes(function.body) for name in callee_names(node))


@cache_by_identity
def dynamic_calls(function: Function) -> frozenset[str]:
    """Return what a function calls that is a variable of its own, or looked up by a text."""
    own = {param.name for param in function.params}
    own.update(name for node in ir_nodes(function.body) for name in _bound_names(node))
    return callees(function) & (own | _DYNAMIC_FUNCTIONS)


def callee_names(node: Any) -> Iterator[str]:  # noqa: ANN401 - any part of the IR
    """Yield the names in what a call calls: those of `RUNS["a"]()` and `(f or g)()` too."""
    if isinstance(node, Call):
        function = node.function
        yield from [function.name] if isinstance(function, Attr) else _names(function)


def aliases(body: Any) -> Iterator[tuple[str, frozenset[str]]]:  # noqa: ANN401 - any part of the IR
    """Yield the names of variables, members and arguments, and the names in what they get."""
    for node in ir_nodes(body):
        if isinstance(node, Import) and node.name and node.alias not in {"", node.name}:
            yield node.alias, frozenset({node.name})
        elif isinstance(node, Assign):
            behind = frozenset(_names(node.value))
            yield from ((name, behind) for target in node.targets for name in _target_names(target))
        elif isinstance(node, Define):
            bases = node.definition.bases if isinstance(node.definition, Class) else ()
            yield node.definition.name, frozenset(_names((bases, node.decorators)))
        elif isinstance(node, Call):
            yield from _argument_aliases(node)


def _argument_aliases(node: Call) -> Iterator[tuple[str, frozenset[str]]]:
    yield from ((word, frozenset(_names(value))) for word, value in node.keywords)
    function = node.function
    if isinstance(function, Attr) and function.name in _ADDING_METHODS:
        given = frozenset(_names(node.args))
        yield from ((name, given) for name in _target_names(function.owner))
    if isinstance(function, Name) and function.id == "setattr" and len(node.args) > 1:
        yield from ((name, frozenset(_names(node.args[2:]))) for name in _texts(node.args[1]))


def _target_names(target: Any) -> Iterator[str]:  # noqa: ANN401 - any expression
    if isinstance(target, Name):
        yield target.id
    elif isinstance(target, Attr):
        yield target.name
    elif isinstance(target, Index):
        yield from _target_names(target.owner)
        yield from _texts(target.key)
    elif isinstance(target, SequenceExpr):
        yield from (name for item in target.items for name in _target_names(item))
    elif isinstance(target, Star):
        yield from _target_names(target.value)


def _texts(key: Any) -> Iterator[str]:  # noqa: ANN401 - any expression
    if isinstance(key, Const) and isinstance(key.value, str):
        yield key.value


def _bound_names(node: Any) -> Iterable[str]:  # noqa: ANN401 - any part of the IR
    if isinstance(node, Assign):
        targets: Iterable[Any] = node.targets
    elif isinstance(node, (AssignExpr, ForEach, With)):
        targets = (node.target,)
    elif isinstance(node, Comprehension):
        targets = (target for target, _, _ in node.loops)
    else:
        return ()
    found = (part for target in targets for part in ir_nodes(target))
    return {part.id for part in found if isinstance(part, Name)}


def _names(part: Any) -> Iterator[str]:  # noqa: ANN401 - any part of the IR
    for node in ir_nodes(part):
        if isinstance(node, Name):
            yield node.id
        elif isinstance(node, Attr):
            yield node.name

"""Nodes of ROS 2 as a program makes them, in C++ and in Python.

A node is an Instance with its full name among its fields. What a launch gives counts before what
is written, and the arguments in a node's own options before both (rcl: rcl_node_init).
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from rtron.sources.code.interpreter.abstract_values.items import items_of, listed
from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    NONE,
    TRUE,
    Hole,
    Instance,
    Known,
    Text,
    Value,
    concat,
    each,
    options,
    parts_of,
    spelled,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros2_common.names import (
    base_of,
    below,
    clean,
    expanded,
    namespace_of,
)
from rtron.sources.declaration import MadeNode

NAME, SUB, GLOBALLY = "node.name", "node.sub", "node.globally"
"""The fields of a node; no member of a class can be called like them."""

_EMPTY = Known("")


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeWords:
    """What a node is made with: its name and namespace as written, and its own arguments."""

    name: Value
    namespace: Value = _EMPTY
    arguments: Value = NONE
    globally: bool = True


def is_node(value: Value | None) -> bool:
    """Tell whether a value is a node, or one of a node's interfaces."""
    return isinstance(value, Instance) and NAME in value.fields


def node_among(values: Iterable[Value]) -> Instance | None:
    """Return the first value that is, or may be, a node."""
    for value in values:
        for option in options(value):
            if isinstance(option, Instance) and NAME in option.fields:
                return option
    return None


def name_of(node: Value) -> Value:
    """Return a node's full name."""
    name = node.fields.get(NAME) if isinstance(node, Instance) else None
    return name if name is not None else Hole("node")


def takes_globals(node: Value) -> bool:
    """Tell whether the arguments of its process count for a node."""
    return not isinstance(node, Instance) or node.fields.get(GLOBALLY) != FALSE


def namespace_at(node: Value) -> Value:
    """Return a node's namespace."""
    return namespace_of(name_of(node))


def base_at(node: Value) -> Value:
    """Return a node's name without its namespace."""
    return base_of(name_of(node))


def resolved(node: Value, name: Value | None) -> Value:
    """Return a name as it resolves at a node, before remapping."""
    sub = node.fields.get(SUB, _EMPTY) if isinstance(node, Instance) else _EMPTY
    return expanded(name if name is not None else Hole("?"), name_of(node), sub)


def full_name(machine: Machine, words: NodeWords) -> Value:
    """Return the full name of a node that is made: the first rule that fits counts (rcl: remap)."""
    site = machine.recorder.site
    written = listed(()) if site.loading else listed(tuple(map(Known, site.args)))
    rules = [*_rules(words.arguments), *(_rules(written) if words.globally else ())]
    name, namespace = words.name, words.namespace
    if words.globally and site.named:
        name = Known(site.process.rpartition("/")[2])
    if words.globally and site.placed:
        namespace = Known(site.process.rpartition("/")[0] or "/")
    name = next(_targets(rules, "__node", words.name), name)
    namespace = next(_targets(rules, "__ns", name), namespace)
    return clean(below(concat((Known("/"), namespace)), name))


def record(machine: Machine, full: Value, words: NodeWords, at: Arguments) -> None:
    """Record a node that the program makes."""
    rules = [r for r in _rules(words.arguments) if not r.left.startswith("__")]
    own = tuple((f"{r.node}:{r.left}" if r.node else r.left, spelled(r.target)) for r in rules)
    for option in options(full):
        name = spelled(option)
        made = MadeNode(name=name, remaps=own, globally=words.globally, evidence=(at.evidence,))
        machine.recorder.node(made)


def sub_node(node: Instance, name: Value) -> Instance:
    """Return `node->create_sub_node(name)`: the same node with a longer namespace."""
    before = node.fields.get(SUB, _EMPTY)
    longer = name if before == _EMPTY else below(before, name)
    return Instance(node.type, {**node.fields, SUB: longer}, node.types, node.bindings)


def own_settings(words: Value) -> Iterator[tuple[str, Value]]:
    """Yield the parameters among the arguments of a node's options: `-p name:=value`."""
    for word, following in _flagged(words):
        if word in {"-p", "--param"}:
            yield from ((name, _plain(value)) for name, value in _assigned(following))


def _plain(value: Value) -> Value:
    """Return the bool that an argument's text means."""
    text = value.value if isinstance(value, Known) else None
    return {"true": TRUE, "false": FALSE}.get(str(text), value)


@dataclass(frozen=True, slots=True)
class _Rule:
    """`node:left:=target`; without `node` it is for every node."""

    node: str
    left: str
    target: Value


def _rules(words: Value) -> Iterator[_Rule]:
    """Yield the remap rules among the arguments of a node, or of a process."""
    for word, following in _flagged(words):
        if word in {"-r", "--remap"}:
            for rule, target in _assigned(following):
                node, colon, rest = rule.partition(":")
                alone = not colon or rest.startswith("//")
                yield _Rule("", rule, target) if alone else _Rule(node, rest, target)


def _targets(rules: Iterable[_Rule], left: str, name: Value) -> Iterator[Value]:
    """Yield what the rules for a node of this name say, the first one counts."""
    for rule in rules:
        if rule.left == left and rule.node in {"", spelled(name)}:
            yield rule.target


def _flagged(words: Value) -> Iterator[tuple[str, Value]]:
    items: Sequence[Value] = items_of(words)[0]
    for word, following in pairwise(items):
        if isinstance(word, Known):
            yield str(word.value), following


def _assigned(word: Value) -> Iterator[tuple[str, Value]]:
    """Yield `left:=right`, whose right side may be known in part."""
    for option in options(word):
        parts = parts_of(option)
        first = parts[0] if parts and isinstance(parts[0], str) else ""
        left, assigned, right = first.partition(":=")
        if assigned:
            rest = (right, *parts[1:]) if right else parts[1:]
            yield left, _text(rest)


def _text(parts: Sequence[str | Hole]) -> Value:
    return concat(tuple(p if isinstance(p, Hole) else Known(p) for p in parts))


def stripped(name: Value) -> Value:
    """Return names without a slash at their beginning."""

    def cut(option: Value) -> Value:
        if isinstance(option, Known):
            return Known(str(option.value).lstrip("/"), option.tainted)
        if isinstance(option, Text) and isinstance(option.parts[0], str):
            first = option.parts[0].lstrip("/")
            return Text((first, *option.parts[1:]), option.tainted)
        return option

    return each(name, cut)

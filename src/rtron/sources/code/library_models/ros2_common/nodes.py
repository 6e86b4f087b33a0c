"""Nodes of ROS 2 as a program makes them, in C++ and in Python.

A node is an Instance with its full name among its fields. What a launch gives counts before what
is written, and the arguments in a node's own options before both (rcl: rcl_node_init).
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros2_common import names
from rtron.sources.declaration import CreatedNode

NAME_FIELD, GLOBAL_ARGUMENTS_FIELD = "node.name", "node.globally"
"""The fields of a node; no member of a class can be called like them."""

_EMPTY = av.Scalar("")


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeArguments:
    """What a node is made with: its name and namespace as written, and its own arguments."""

    name: av.Value
    namespace: av.Value = _EMPTY
    arguments: av.Value = av.NONE
    uses_global_arguments: bool = True


def is_node(value: av.Value | None) -> bool:
    """Tell whether a value is a node, or one of a node's interfaces."""
    return isinstance(value, av.Instance) and NAME_FIELD in value.fields


def first_node(values: Iterable[av.Value]) -> av.Instance | None:
    """Return the first value that is, or may be, a node."""
    for value in values:
        for option in av.options(value):
            if isinstance(option, av.Instance) and NAME_FIELD in option.fields:
                return option
    return None


def node_name(node: av.Value) -> av.Value:
    """Return a node's full name."""
    name = node.fields.get(NAME_FIELD) if isinstance(node, av.Instance) else None
    return name if name is not None else av.Unknown("node")


def uses_global_arguments(node: av.Value) -> bool:
    """Tell whether the arguments of its process count for a node."""
    return not isinstance(node, av.Instance) or node.fields.get(GLOBAL_ARGUMENTS_FIELD) != av.FALSE


def node_namespace(node: av.Value) -> av.Value:
    """Return a node's namespace."""
    return names.namespace_of(node_name(node))


def node_base_name(node: av.Value) -> av.Value:
    """Return a node's name without its namespace."""
    return names.base_name(node_name(node))


def resolve_at_node(node: av.Value, name: av.Value | None) -> av.Value:
    """Return a name as it resolves at a node, before remapping."""
    return names.expand_name(name if name is not None else av.UNKNOWN, node_name(node))


def full_name(machine: AbstractMachine, words: NodeArguments) -> av.Value:
    """Return the full name of a node that is made: the first rule that fits counts (rcl: remap)."""
    site = machine.recorder.site
    written = av.list_of(()) if site.loading else av.list_of(tuple(map(av.Scalar, site.args)))
    rules = [
        *_remap_rules(words.arguments),
        *(_remap_rules(written) if words.uses_global_arguments else ()),
    ]
    name, namespace = words.name, words.namespace
    if words.uses_global_arguments and site.has_launch_name:
        name = av.Scalar(site.process_name.rpartition("/")[2])
    if words.uses_global_arguments and site.has_launch_namespace:
        namespace = av.Scalar(site.process_name.rpartition("/")[0] or "/")
    name = next(_rule_targets(rules, "__node", words.name), name)
    namespace = next(_rule_targets(rules, "__ns", name), namespace)
    return names.clean_name(names.name_below(av.concat((av.Scalar("/"), namespace)), name))


def record_node(
    machine: AbstractMachine, full: av.Value, words: NodeArguments, at: Arguments
) -> None:
    """Record a node that the program makes."""
    rules = [r for r in _remap_rules(words.arguments) if not r.left.startswith("__")]
    own = tuple(
        (f"{r.node}:{r.left}" if r.node else r.left, av.text_with_holes(r.target)) for r in rules
    )
    for option in av.options(full):
        name = av.text_with_holes(option)
        made = CreatedNode(
            name=name,
            remaps=own,
            uses_global_arguments=words.uses_global_arguments,
            evidence=(at.evidence,),
        )
        machine.recorder.add_node(made)


def own_parameters(words: av.Value) -> Iterator[tuple[str, av.Value]]:
    """Yield the parameters among the arguments of a node's options: `-p name:=value`."""
    for word, following in _word_pairs(words):
        if word in {"-p", "--param"}:
            yield from ((name, _bool_or_text(value)) for name, value in _assignments(following))


def _bool_or_text(value: av.Value) -> av.Value:
    """Return the bool that an argument's text means."""
    text = value.value if isinstance(value, av.Scalar) else None
    return {"true": av.TRUE, "false": av.FALSE}.get(str(text), value)


@dataclass(frozen=True, slots=True)
class _RemapRule:
    """`node:left:=target`; without `node` it is for every node."""

    node: str
    left: str
    target: av.Value


def _remap_rules(words: av.Value) -> Iterator[_RemapRule]:
    """Yield the remap rules among the arguments of a node, or of a process."""
    for word, following in _word_pairs(words):
        if word in {"-r", "--remap"}:
            for rule, target in _assignments(following):
                node, colon, rest = rule.partition(":")
                applies_to_all = not colon or rest.startswith("//")
                yield (
                    _RemapRule("", rule, target)
                    if applies_to_all
                    else _RemapRule(node, rest, target)
                )


def _rule_targets(rules: Iterable[_RemapRule], left: str, name: av.Value) -> Iterator[av.Value]:
    """Yield what the rules for a node of this name say, the first one counts."""
    for rule in rules:
        if rule.left == left and rule.node in {"", av.text_with_holes(name)}:
            yield rule.target


def _word_pairs(words: av.Value) -> Iterator[tuple[str, av.Value]]:
    items: Sequence[av.Value] = av.items_of(words)[0]
    for word, following in pairwise(items):
        if isinstance(word, av.Scalar):
            yield str(word.value), following


def _assignments(word: av.Value) -> Iterator[tuple[str, av.Value]]:
    """Yield `left:=right`, whose right side may be known in part."""
    for option in av.options(word):
        parts = av.parts_of(option)
        first = parts[0] if parts and isinstance(parts[0], str) else ""
        left, assigned, right = first.partition(":=")
        if assigned:
            rest = (right, *parts[1:]) if right else parts[1:]
            yield left, _join_parts(rest)


def _join_parts(parts: Sequence[str | av.Unknown]) -> av.Value:
    return av.concat(tuple(p if isinstance(p, av.Unknown) else av.Scalar(p) for p in parts))

"""Names of ROS 2 that may be known in part (design.ros2.org: Topic and Service name mapping)."""

import re
from collections.abc import Iterable

from rtron.sources.code.interpreter.abstract_values.value_types import (
    PartialText,
    Scalar,
    Unknown,
    Value,
    concat,
    is_tainted,
    join,
    map_options,
    options,
    parts_of,
)

_SLASHES = re.compile("/{2,}")
_ROOT = Scalar("/")


def clean_name(name: Value) -> Value:
    """Return names without doubled or trailing slashes."""

    def cleaned(option: Value) -> Value:
        if isinstance(option, Scalar):
            text = _SLASHES.sub("/", str(option.value))
            return Scalar(text.rstrip("/") or text[:1], option.tainted)
        if isinstance(option, PartialText):
            parts = [p if isinstance(p, Unknown) else _SLASHES.sub("/", p) for p in option.parts]
            return _join_parts(parts, tainted=option.tainted)
        return option

    return map_options(name, cleaned)


def _join_parts(parts: Iterable[str | Unknown], *, tainted: bool) -> Value:
    values = (p if isinstance(p, Unknown) else Scalar(p, tainted) for p in parts)
    return concat(tuple(values))


def namespace_of(full: Value) -> Value:
    """Return the namespace of a node's full name."""

    def cut(option: Value) -> Value:
        parts = list(parts_of(option))
        while parts:
            last = parts.pop()
            if isinstance(last, str) and "/" in last:
                remaining = [*parts, last.rpartition("/")[0]]
                found = _join_parts(remaining, tainted=is_tainted(option))
                return _ROOT if found == Scalar("", is_tainted(option)) else found
        return _ROOT

    return map_options(full, cut)


def base_name(full: Value) -> Value:
    """Return the last part of a node's full name."""

    def cut(option: Value) -> Value:
        parts, remaining = list(parts_of(option)), list[str | Unknown]()
        while parts:
            last = parts.pop()
            if isinstance(last, str) and "/" in last:
                return _join_parts(
                    [last.rpartition("/")[2], *remaining], tainted=is_tainted(option)
                )
            remaining.insert(0, last)
        return _join_parts(remaining, tainted=is_tainted(option))

    return map_options(full, cut)


def name_below(namespace: Value, name: Value) -> Value:
    """Return a relative name below a namespace."""
    return clean_name(concat((namespace, _ROOT, name)))


def expand_name(name: Value, node: Value, sub: Value) -> Value:
    """Return a name as rcl expands it at a node, before remapping.

    `sub` is the sub-namespace of a sub-node; it counts for relative names only (rclcpp).
    """
    return join([_expand_one(one, full, sub) for one in options(name) for full in options(node)])


def _expand_one(name: Value, node: Value, sub: Value) -> Value:
    name = _substitute(name, node)
    parts = parts_of(name)
    first = parts[0] if parts and isinstance(parts[0], str) else ""
    if first.startswith("/"):
        return clean_name(name)
    if first.startswith("~"):
        rest = _join_parts([first[1:], *parts[1:]], tainted=is_tainted(name))
        return clean_name(concat((node, rest)))
    space = namespace_of(node)
    return (
        name_below(space, name) if sub == Scalar("") else name_below(name_below(space, sub), name)
    )


def _substitute(name: Value, node: Value) -> Value:
    """Replace rcl's `{node}`, `{ns}` and `{namespace}`."""
    if not isinstance(name, Scalar) or "{" not in str(name.value):
        return name
    found = {
        "{node}": base_name(node),
        "{ns}": namespace_of(node),
        "{namespace}": namespace_of(node),
    }
    pieces = re.split(r"(\{node\}|\{ns\}|\{namespace\})", str(name.value))
    return concat(found.get(piece, Scalar(piece, name.tainted)) for piece in pieces)

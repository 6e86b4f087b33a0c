"""Names of ROS 2 that may be known in part (design.ros2.org: Topic and Service name mapping)."""

import re
from collections.abc import Iterable

from rtron.sources.code.interpreter.abstract_values.value_types import (
    Hole,
    Known,
    Text,
    Value,
    concat,
    each,
    is_tainted,
    join,
    options,
    parts_of,
)

_SLASHES = re.compile("/{2,}")
_ROOT = Known("/")


def clean(name: Value) -> Value:
    """Return names without doubled or trailing slashes."""

    def cleaned(option: Value) -> Value:
        if isinstance(option, Known):
            text = _SLASHES.sub("/", str(option.value))
            return Known(text.rstrip("/") or text[:1], option.tainted)
        if isinstance(option, Text):
            parts = [p if isinstance(p, Hole) else _SLASHES.sub("/", p) for p in option.parts]
            return _whole(parts, tainted=option.tainted)
        return option

    return each(name, cleaned)


def _whole(parts: Iterable[str | Hole], *, tainted: bool) -> Value:
    values = (p if isinstance(p, Hole) else Known(p, tainted) for p in parts)
    return concat(tuple(values))


def namespace_of(full: Value) -> Value:
    """Return the namespace of a node's full name."""

    def cut(option: Value) -> Value:
        parts = list(parts_of(option))
        while parts:
            last = parts.pop()
            if isinstance(last, str) and "/" in last:
                kept = [*parts, last.rpartition("/")[0]]
                found = _whole(kept, tainted=is_tainted(option))
                return _ROOT if found == Known("", is_tainted(option)) else found
        return _ROOT

    return each(full, cut)


def base_of(full: Value) -> Value:
    """Return the last part of a node's full name."""

    def cut(option: Value) -> Value:
        parts, kept = list(parts_of(option)), list[str | Hole]()
        while parts:
            last = parts.pop()
            if isinstance(last, str) and "/" in last:
                return _whole([last.rpartition("/")[2], *kept], tainted=is_tainted(option))
            kept.insert(0, last)
        return _whole(kept, tainted=is_tainted(option))

    return each(full, cut)


def below(namespace: Value, name: Value) -> Value:
    """Return a relative name below a namespace."""
    return clean(concat((namespace, _ROOT, name)))


def expanded(name: Value, node: Value, sub: Value) -> Value:
    """Return a name as rcl expands it at a node, before remapping.

    `sub` is the sub-namespace of a sub-node; it counts for relative names only (rclcpp).
    """
    return join([_expanded(one, full, sub) for one in options(name) for full in options(node)])


def _expanded(name: Value, node: Value, sub: Value) -> Value:
    name = _substituted(name, node)
    parts = parts_of(name)
    first = parts[0] if parts and isinstance(parts[0], str) else ""
    if first.startswith("/"):
        return clean(name)
    if first.startswith("~"):
        rest = _whole([first[1:], *parts[1:]], tainted=is_tainted(name))
        return clean(concat((node, rest)))
    space = namespace_of(node)
    return below(space, name) if sub == Known("") else below(below(space, sub), name)


def _substituted(name: Value, node: Value) -> Value:
    """Replace rcl's `{node}`, `{ns}` and `{namespace}`."""
    if not isinstance(name, Known) or "{" not in str(name.value):
        return name
    found = {"{node}": base_of(node), "{ns}": namespace_of(node), "{namespace}": namespace_of(node)}
    pieces = re.split(r"(\{node\}|\{ns\}|\{namespace\})", str(name.value))
    return concat(found.get(piece, Known(piece, name.tainted)) for piece in pieces)

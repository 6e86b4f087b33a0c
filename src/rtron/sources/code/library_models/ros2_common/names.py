"""Names of ROS 2 that may be known in part (design.ros2.org: Topic and Service name mapping)."""

import re
from collections.abc import Iterable

from rtron.sources.code.interpreter import abstract_values as av

_SLASHES = re.compile("/{2,}")
_ROOT = av.Scalar("/")


def clean_name(name: av.Value) -> av.Value:
    """Return names without doubled or trailing slashes."""

    def cleaned(option: av.Value) -> av.Value:
        if isinstance(option, av.Scalar):
            text = _SLASHES.sub("/", str(option.value))
            return av.Scalar(text.rstrip("/") or text[:1], option.tainted)
        if isinstance(option, av.PartialText):
            parts = [p if isinstance(p, av.Unknown) else _SLASHES.sub("/", p) for p in option.parts]
            return _join_parts(parts, tainted=option.tainted)
        return option

    return av.map_options(name, cleaned)


def _join_parts(parts: Iterable[str | av.Unknown], *, tainted: bool) -> av.Value:
    values = (p if isinstance(p, av.Unknown) else av.Scalar(p, tainted) for p in parts)
    return av.concat(tuple(values))


def namespace_of(full: av.Value) -> av.Value:
    """Return the namespace of a node's full name."""

    def cut(option: av.Value) -> av.Value:
        parts = list(av.parts_of(option))
        while parts:
            last = parts.pop()
            if isinstance(last, str) and "/" in last:
                remaining = [*parts, last.rpartition("/")[0]]
                found = _join_parts(remaining, tainted=av.is_tainted(option))
                return _ROOT if found == av.Scalar("", av.is_tainted(option)) else found
        return _ROOT

    return av.map_options(full, cut)


def base_name(full: av.Value) -> av.Value:
    """Return the last part of a node's full name."""

    def cut(option: av.Value) -> av.Value:
        parts, remaining = list(av.parts_of(option)), list[str | av.Unknown]()
        while parts:
            last = parts.pop()
            if isinstance(last, str) and "/" in last:
                return _join_parts(
                    [last.rpartition("/")[2], *remaining], tainted=av.is_tainted(option)
                )
            remaining.insert(0, last)
        return _join_parts(remaining, tainted=av.is_tainted(option))

    return av.map_options(full, cut)


def name_below(namespace: av.Value, name: av.Value) -> av.Value:
    """Return a relative name below a namespace."""
    return clean_name(av.concat((namespace, _ROOT, name)))


def expand_name(name: av.Value, node: av.Value) -> av.Value:
    """Return a name as rcl expands it at a node, before remapping."""
    return av.join(
        [_expand_one(one, full) for one in av.options(name) for full in av.options(node)]
    )


def _expand_one(name: av.Value, node: av.Value) -> av.Value:
    name = _substitute(name, node)
    parts = av.parts_of(name)
    first = parts[0] if parts and isinstance(parts[0], str) else ""
    if first.startswith("/"):
        return clean_name(name)
    if first.startswith("~"):
        rest = _join_parts([first[1:], *parts[1:]], tainted=av.is_tainted(name))
        return clean_name(av.concat((node, rest)))
    return name_below(namespace_of(node), name)


def _substitute(name: av.Value, node: av.Value) -> av.Value:
    """Replace rcl's `{node}`, `{ns}` and `{namespace}`."""
    if not isinstance(name, av.Scalar) or "{" not in str(name.value):
        return name
    found = {
        "{node}": base_name(node),
        "{ns}": namespace_of(node),
        "{namespace}": namespace_of(node),
    }
    pieces = re.split(r"(\{node\}|\{ns\}|\{namespace\})", str(name.value))
    return av.concat(found.get(piece, av.Scalar(piece, name.tainted)) for piece in pieces)

"""Joins the variables of branches of which a build takes one."""

from collections.abc import Mapping, Sequence

from rtron.sources.workspace.cmake.values import Value, split


def join(results: Sequence[Mapping[str, Value]]) -> dict[str, Value]:
    """Return the variables after a choice: where the branches differ, all their elements."""
    first, *others = results
    joined = dict(first)
    for other in others:
        for name, value in other.items():
            old = joined.get(name)
            if old is not value:
                joined[name] = _both(old, value)
        for name in joined.keys() - other.keys():
            joined[name] = Value(joined[name].text, known=False)
    return joined


def _both(old: Value | None, new: Value) -> Value:
    if old == new:
        return new
    elements = dict.fromkeys((*(split(old.text) if old else ()), *split(new.text)))
    return Value(";".join(elements), known=False)

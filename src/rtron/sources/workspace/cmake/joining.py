"""Joins the variables of branches of which a build takes one."""

from collections.abc import Mapping, Sequence

from rtron.sources.workspace.cmake.values import VariableValue, split_list


def join_variables(results: Sequence[Mapping[str, VariableValue]]) -> dict[str, VariableValue]:
    """Return the variables after a choice: where the branches differ, all their elements."""
    first, *others = results
    joined = dict(first)
    for other in others:
        for name, value in other.items():
            old = joined.get(name)
            if old is not value:
                joined[name] = _join_values(old, value)
        for name in joined.keys() - other.keys():
            joined[name] = VariableValue(joined[name].text, known=False)
    return joined


def _join_values(old: VariableValue | None, new: VariableValue) -> VariableValue:
    if old == new:
        return new
    elements = dict.fromkeys((*(split_list(old.text) if old else ()), *split_list(new.text)))
    return VariableValue(";".join(elements), known=False)

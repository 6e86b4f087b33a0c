"""Taking a change of settings back: what it set is as it was, what others set since stays."""

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any, TypeVar

from rtron.coherence import EffectivePlan
from rtron.service.domain.settings_checks import check_settings
from rtron.service.domain.settings_patch import Patch, merge_patch
from rtron.vocabulary import FlowSettings, NodeSettings, Plan, RuleSettings, Settings

Nodes = Mapping[str, NodeSettings]
_Part = TypeVar("_Part", NodeSettings, FlowSettings, RuleSettings)
_PARTS: Mapping[str, type[FlowSettings] | type[RuleSettings]] = {
    "flows": FlowSettings,
    "rules": RuleSettings,
}


def plan_without_change(
    plan: Plan, before: Settings, nodes: Mapping[str, Patch], current: Settings
) -> EffectivePlan | None:
    """Return the plan without a change of `nodes` that was made on top of `before`.

    None if nothing of it is in force; InputError if what remains makes no plan any more.
    """
    changed = merge_patch(plan, before, nodes)
    remaining = take_back(before.nodes, changed.nodes, current.nodes)
    if remaining == current.nodes:
        return None
    after = replace(current, nodes=remaining, revision=current.revision + 1)
    effective = EffectivePlan(plan, after)
    check_settings(effective)
    return effective


def take_back(before: Nodes, changed: Nodes, current: Nodes) -> dict[str, NodeSettings]:
    """Return `current` without what differs between `before` and `changed` and still is so."""
    nodes = _merge_named(before, changed, current, NodeSettings())
    return {id: node for id, node in nodes.items() if node != NodeSettings()}


def _merge_named(
    before: Mapping[str, Any],
    changed: Mapping[str, Any],
    current: Mapping[str, Any],
    empty: Any,  # noqa: ANN401 - a part of settings
) -> dict[str, Any]:
    return {
        name: _merge(before.get(name, empty), changed.get(name, empty), current.get(name, empty))
        for name in before.keys() | changed.keys() | current.keys()
    }


def _merge(before: _Part, changed: _Part, current: _Part) -> _Part:
    values: dict[str, Any] = {}
    for each in fields(before):
        was, set_to, now = (getattr(part, each.name) for part in (before, changed, current))
        if each.name in _PARTS:
            empty = _PARTS[each.name]()
            merged = _merge_named(was, set_to, now, empty)
            values[each.name] = {name: part for name, part in merged.items() if part != empty}
        elif was != set_to and now == set_to:
            values[each.name] = was
    return replace(current, **values)

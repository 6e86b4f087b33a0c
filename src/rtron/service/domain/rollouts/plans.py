"""Another plan for a robot, as part of its settings: who may, whether it can, and going back."""

from collections.abc import Mapping
from dataclasses import fields, replace
from itertools import islice
from typing import Any, TypeVar

from rtron.coherence import EffectivePlan, relaunch_reasons
from rtron.errors import InputError
from rtron.service.domain.errors import ForbiddenError
from rtron.service.domain.principal import Principal, UserRole
from rtron.service.domain.settings_checks import check_settings, drop_misfits
from rtron.service.domain.settings_patch import Patch, merge_patch
from rtron.vocabulary import FlowSettings, NodeSettings, Plan, RuleSettings, Settings
from rtron.wire.common.link_protocol import Applied

_MAX_LISTED = 5


def check_plan_right(caller: Principal) -> None:
    """Raise ForbiddenError unless the caller may give robots another plan."""
    if UserRole.DEVELOPER not in caller.roles:
        raise ForbiddenError("a new plan takes the role developer", help="ask a developer")


def check_plan_change(current: Plan, new: Plan) -> None:
    """Raise InputError for a plan that needs the app to be launched anew."""
    if reasons := list(islice(relaunch_reasons(current, new), _MAX_LISTED)):
        message = f"the plan needs a new launch: {', '.join(reasons)}"
        raise InputError(message, help="run rtron instrument and launch the app again")


def checked_answer(applied: Applied, settings: Settings) -> Applied:
    """Return what a guard answers to settings, as a refusal where another plan is in force.

    So answers one of a version that knows of no plans.
    """
    if applied.error or applied.plan == settings.plan:
        return applied
    return replace(applied, error="its guard has another plan: rtron guard --plans takes new ones")


def with_plan(settings: Settings, new: Plan, digest: str) -> Settings | None:
    """Return settings with another plan, without what does not fit it; None if they have it."""
    if settings.plan == digest:
        return None
    remaining, _ = drop_misfits(new, settings)
    return replace(remaining, plan=digest, revision=settings.revision + 1)


def without_plan(settings: Settings, sent: str, digest: str, before: str) -> Settings | None:
    """Return settings with the plan `before` again; None if the newest name another than `digest`.

    `sent` is what the newest name: the robot is not to try a plan again that it has refused.
    """
    if sent != digest:
        return None
    return replace(settings, plan=before, revision=settings.revision + 1)


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

"""What people ask for, decided: the new settings, or why not. No database, no clock, no guard."""

from collections.abc import Collection
from dataclasses import replace

from rtron.coherence import EffectivePlan
from rtron.errors import InputError
from rtron.service.domain.errors import ConflictError, ForbiddenError, NotFoundError
from rtron.service.domain.principal import Right, UserRole
from rtron.service.domain.rights import (
    RIGHTS_BY_ROLE,
    NodeRight,
    coordination_kinds,
    granted_rights,
    mandatory_violations,
    missing_rights,
    named_rights,
    needed_rights,
)
from rtron.service.domain.schemas import (
    MIN_REASON_LENGTH,
    OverrideRequest,
    SettingsChange,
    SettingsView,
)
from rtron.service.domain.settings_checks import check_settings
from rtron.service.domain.settings_patch import merge_patch
from rtron.vocabulary import SECOND, EmergencyStop, Plan, Settings, TimedOverride


class StaleRevisionError(ConflictError):
    """The settings have changed meanwhile; `newest` is what they are now."""

    def __init__(self, newest: SettingsView) -> None:
        message = f"the settings are at revision {newest.revision}, made by {newest.by}"
        super().__init__(message, help="look at them, then ask again with that revision")
        self.newest = newest


def apply_change(
    plan: Plan, before: Settings, roles: Collection[UserRole], change: SettingsChange
) -> EffectivePlan:
    """Return the plan under the settings with a change merged in, their revision one higher.

    InputError if the change has no reason, is empty or makes no plan, ForbiddenError if the roles
    do not suffice.
    """
    _require_reason(change.reason, "a change of settings")
    merged = merge_patch(plan, before, change.nodes)
    after = EffectivePlan(plan, replace(merged, revision=before.revision + 1))
    needed = needed_rights(plan, before, after.settings) | named_rights(plan, change.nodes)
    _check_rights(roles, after, needed)
    check_settings(after)
    return after


def restore_nodes(
    plan: Plan, before: Settings, roles: Collection[UserRole], earlier: Settings
) -> EffectivePlan:
    """Return the plan under the nodes' settings of an earlier revision, as one change.

    InputError if they do not fit the plan any more, ForbiddenError if the roles do not suffice.
    """
    restored = replace(before, nodes=earlier.nodes, revision=before.revision + 1)
    after = EffectivePlan(plan, restored)
    _check_rights(roles, after, needed_rights(plan, before, after.settings))
    check_settings(after)
    return after


def add_override(
    before: Settings, actor: str, node: str, request: OverrideRequest, now: int
) -> Settings:
    """Return the settings with an override of a coordination node from `now` (ns) on."""
    until = now + round(request.duration * SECOND)
    override = TimedOverride(by=actor, reason=request.reason, until=until)
    overrides = {**before.overrides, node: override}
    return replace(before, overrides=overrides, revision=before.revision + 1)


def remove_override(before: Settings, node: str, reason: str) -> Settings:
    """Return the settings without the override of a coordination node; InputError: no reason."""
    if node not in before.overrides:
        raise NotFoundError(f"{node} is not overridden", help="its policy is in force")
    _require_reason(reason, "the end of an override")
    overrides = {id: each for id, each in before.overrides.items() if id != node}
    return replace(before, overrides=overrides, revision=before.revision + 1)


def add_stop(before: Settings, actor: str, reason: str, now: int) -> Settings:
    """Return the settings with the emergency stop; the same one stays, another's is replaced."""
    stop = EmergencyStop(by=actor, reason=reason, at=now)
    if before.stop and is_same_stop(before.stop, actor, reason):
        stop = before.stop
    return replace(before, stop=stop, revision=before.revision + 1)


def is_same_stop(stop: EmergencyStop, actor: str, reason: str) -> bool:
    """Tell whether somebody stops for what they have stopped for already."""
    return (stop.by, stop.reason) == (actor, reason)


def remove_stop(before: Settings, reason: str) -> Settings:
    """Return the settings without the emergency stop; InputError without a reason."""
    if before.stop is None:
        raise NotFoundError("the robot is not stopped", help="there is no stop to release")
    _require_reason(reason, "the end of an emergency stop")
    return replace(before, stop=None, revision=before.revision + 1)


def check_override_right(plan: Plan, roles: Collection[UserRole], node: str) -> None:
    """Raise unless the roles may override a coordination node; NotFoundError if it is none."""
    kinds_by_id = coordination_kinds(plan)
    if node not in kinds_by_id:
        raise NotFoundError(
            f"no coordination node is called {node[:80]}", help=_known_nodes(kinds_by_id)
        )
    if Right.OVERRIDE not in granted_rights(roles, kinds_by_id[node]):
        message = f"a {kinds_by_id[node]} cannot be overridden by {_role_names(roles)}"
        raise ForbiddenError(message, help=_who_may(plan, node, Right.OVERRIDE))


def check_stop_right(roles: Collection[UserRole]) -> None:
    """Raise ForbiddenError for who has no role: everybody else may stop a robot."""
    if not roles:
        raise ForbiddenError("an emergency stop takes a role", help="any role will do")


def _require_reason(reason: str, change: str) -> None:
    if len(reason) < MIN_REASON_LENGTH:
        help = f"say why in `reason`, in at least {MIN_REASON_LENGTH} characters that can be seen"
        raise InputError(f"{change} needs a reason", help=help)


def _check_rights(
    roles: Collection[UserRole], after: EffectivePlan, needed: Collection[NodeRight]
) -> None:
    plan = after.base
    breaches = list(mandatory_violations(after))
    missing = missing_rights(plan, roles, needed)
    if missing:
        denied = ", ".join(f"{right} at {node}" for node, right in missing)
        raise ForbiddenError(
            f"{_role_names(roles)} may not {denied}", help=_who_may(plan, *missing[0])
        )
    if breaches:
        raise ForbiddenError("; ".join(breaches), help="it is the plan that would have to change")


def _who_may(plan: Plan, node: str, right: Right) -> str:
    kind = coordination_kinds(plan)[node]
    roles = [role for role in UserRole if right in RIGHTS_BY_ROLE.get(role, {}).get(kind, ())]
    if not roles:
        return f"no role may {right} at a {kind}: change it in the plan"
    return f"ask somebody with the role {' or '.join(roles)}"


def _role_names(roles: Collection[UserRole]) -> str:
    return " and ".join(sorted(roles)) or "who has no role"


def _known_nodes(node_ids: Collection[str]) -> str:
    return f"there are: {', '.join(list(node_ids)[:20])}"

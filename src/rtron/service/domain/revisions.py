"""What people ask for, decided: the new settings, or why not. No database, no clock, no guard."""

from collections.abc import Collection
from dataclasses import replace

from rtron.errors import InputError
from rtron.service.domain.errors import ConflictError, ForbiddenError, NotFoundError
from rtron.service.domain.rights import (
    RIGHTS,
    kinds,
    mandatory_breaches,
    missing_rights,
    needed_rights,
    rights,
)
from rtron.service.domain.schemas import (
    OverrideRequest,
    Right,
    SettingsChange,
    SettingsView,
    UserRole,
)
from rtron.service.domain.settings_checks import checked, fits
from rtron.service.domain.settings_patch import merged
from rtron.vocabulary import SECOND, EmergencyStop, Plan, Settings, TimedOverride

_SHORTEST_REASON = 3


class RevisionError(ConflictError):
    """The settings have changed meanwhile; `newest` is what they are now."""

    def __init__(self, newest: SettingsView) -> None:
        told = f"the settings are at revision {newest.revision}, made by {newest.by}"
        super().__init__(told, help="look at them, then ask again with that revision")
        self.newest = newest


def changed(
    plan: Plan, before: Settings, roles: Collection[UserRole], change: SettingsChange
) -> Settings:
    """Return the settings with a change merged in, its revision one higher.

    InputError if the change is none or makes no plan, ForbiddenError if the roles do not suffice.
    """
    after = merged(plan, before, change.nodes)
    fits(plan, after)
    _allow(plan, roles, before, after)
    checked(plan, after)
    return replace(after, revision=before.revision + 1)


def overridden(
    before: Settings, who: str, node: str, request: OverrideRequest, now: int
) -> Settings:
    """Return the settings with an override of a coordination node from `now` (ns) on."""
    until = now + round(request.duration * SECOND)
    override = TimedOverride(by=who, reason=request.reason, until=until)
    overrides = {**before.overrides, node: override}
    return replace(before, overrides=overrides, revision=before.revision + 1)


def in_force_again(before: Settings, node: str) -> Settings:
    """Return the settings without the override of a coordination node."""
    if node not in before.overrides:
        raise NotFoundError(f"{node} is not overridden", help="it is in force")
    overrides = {id: each for id, each in before.overrides.items() if id != node}
    return replace(before, overrides=overrides, revision=before.revision + 1)


def stopped(before: Settings, who: str, reason: str, now: int) -> Settings:
    """Return the settings with the emergency stop; the same one stays, another's is replaced."""
    stop = EmergencyStop(by=who, reason=reason, at=now)
    if before.stop and is_same(before.stop, who, reason):
        stop = before.stop
    return replace(before, stop=stop, revision=before.revision + 1)


def is_same(stop: EmergencyStop, who: str, reason: str) -> bool:
    """Tell whether somebody stops for what they have stopped for already."""
    return (stop.by, stop.reason) == (who, reason)


def released(before: Settings, reason: str) -> Settings:
    """Return the settings without the emergency stop."""
    if before.stop is None:
        raise NotFoundError("the robot is not stopped", help="nothing is to be released")
    if len(reason) < _SHORTEST_REASON:
        raise InputError("the end of an emergency stop needs a reason", help="say why it is safe")
    return replace(before, stop=None, revision=before.revision + 1)


def allow_override(plan: Plan, roles: Collection[UserRole], node: str) -> None:
    """Raise unless the roles may override a coordination node; NotFoundError if it is none."""
    known = kinds(plan)
    if node not in known:
        raise NotFoundError(f"no coordination node is called {node[:80]}", help=_choice(known))
    if Right.OVERRIDE not in rights(roles, known[node]):
        told = f"a {known[node]} cannot be overridden by {_said(roles)}"
        raise ForbiddenError(told, help=_who(plan, node, Right.OVERRIDE))


def allow_stop(roles: Collection[UserRole]) -> None:
    """Raise ForbiddenError for who has no role: everybody else may stop a robot."""
    if not roles:
        raise ForbiddenError("an emergency stop takes a role", help="any role will do")


def _allow(plan: Plan, roles: Collection[UserRole], before: Settings, after: Settings) -> None:
    missing = missing_rights(plan, roles, needed_rights(plan, before, after))
    if missing:
        told = ", ".join(f"{right} at {node}" for node, right in missing)
        raise ForbiddenError(f"{_said(roles)} may not {told}", help=_who(plan, *missing[0]))
    breaches = list(mandatory_breaches(plan, after))
    if breaches:
        raise ForbiddenError("; ".join(breaches), help="it is the plan that would have to change")


def _who(plan: Plan, node: str, right: Right) -> str:
    kind = kinds(plan)[node]
    roles = [role for role in UserRole if right in RIGHTS.get(role, {}).get(kind, ())]
    if not roles:
        return f"nobody may {right} at a {kind}: only the plan says it"
    return f"ask somebody with the role {' or '.join(roles)}"


def _said(roles: Collection[UserRole]) -> str:
    return " and ".join(sorted(roles)) or "who has no role"


def _choice(known: Collection[str]) -> str:
    return f"there are: {', '.join(list(known)[:20])}"

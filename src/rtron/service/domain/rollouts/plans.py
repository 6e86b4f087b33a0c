"""Another plan for a robot, as part of its settings: who may, whether it can, and going back."""

from dataclasses import replace
from itertools import islice

from rtron.coherence import relaunch_reasons
from rtron.errors import InputError
from rtron.service.domain.errors import ForbiddenError
from rtron.service.domain.principal import Principal
from rtron.service.domain.roles import UserRole
from rtron.service.domain.settings_checks import drop_misfits
from rtron.vocabulary import Plan, Settings
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

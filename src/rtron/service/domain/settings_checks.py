"""Whether settings may go out: the plan that they make must pass what `rtron check` asks."""

from collections.abc import Iterator
from dataclasses import replace

from rtron.errors import InputError
from rtron.planning.coherence import misfits
from rtron.planning.plan_file.loader import has_expressions
from rtron.service.domain.rights import mandatory_breaches
from rtron.vocabulary import MisfitError, Plan, Settings, effective_plan, fitting
from rtron.vocabulary.settings_validation import in_force

_MOST_TOLD = 5


def fits(plan: Plan, settings: Settings) -> Plan:
    """Return the plan in force under settings; InputError if they name what it does not have."""
    try:
        return effective_plan(plan, settings)
    except MisfitError as error:
        raise InputError(str(error)) from None


def checked(plan: Plan, settings: Settings) -> Plan:
    """Return the plan in force under settings; InputError with what is wrong with it.

    What is wrong with the plan itself, without settings, is not held against them.
    """
    after = fits(plan, settings)
    found = _new_faults(plan, after)
    if found:
        (told, help), *others = found[:_MOST_TOLD]
        raise InputError("; ".join([told, *(text for text, _ in others)]), help=help)
    _ask_the_guard(plan, settings)
    return after


def still_fitting(plan: Plan, settings: Settings) -> tuple[Settings, tuple[str, ...]]:
    """Return what is left of settings under another plan, and what had to be left out and why."""
    left, lost = fitting(plan, settings)
    for id in tuple(left.nodes):
        alone = Settings(nodes={id: left.nodes[id]})
        if why := _refusal(plan, alone):
            left = replace(left, nodes={i: node for i, node in left.nodes.items() if i != id})
            lost += (why,)
    if why := _refusal(plan, left):
        return replace(left, nodes={}), (*lost, why)
    return left, lost


def _ask_the_guard(plan: Plan, settings: Settings) -> None:
    """Raise InputError for what the guard itself would refuse."""
    try:
        in_force(plan, settings)
    except MisfitError as error:
        raise InputError(str(error)) from None


def _refusal(plan: Plan, settings: Settings) -> str:
    try:
        checked(plan, settings)
    except InputError as error:
        return str(error)
    return "; ".join(mandatory_breaches(plan, settings))


def _new_faults(plan: Plan, after: Plan) -> list[tuple[str, str]]:
    """Return what is wrong with `after` and was not with `plan`; expressions if they may differ."""
    rules_differ = plan.msrcn != after.msrcn
    found = dict.fromkeys(_faults(after, expressions=rules_differ))
    old = set(_faults(plan, expressions=rules_differ)) if found else set()
    return [fault for fault in found if fault not in old]


def _faults(plan: Plan, *, expressions: bool) -> Iterator[tuple[str, str]]:
    """Yield what is wrong with a plan, and what to do about it."""
    for _, _, told in misfits(plan):
        yield told, ""
    if expressions and has_expressions(plan):
        from rtron.planning.expressions import expression_faults  # noqa: PLC0415 - seldom needed

        for _, _, error in expression_faults(plan):
            yield str(error), error.help

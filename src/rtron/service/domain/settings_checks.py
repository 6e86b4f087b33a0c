"""Whether settings may go out: the plan that they make must pass what `rtron check` asks."""

from collections.abc import Iterator
from dataclasses import replace

from rtron.coherence import EffectivePlan, compatible_settings
from rtron.errors import InputError
from rtron.planning.plan_file.loader import has_expressions
from rtron.service.domain.rights import mandatory_violations
from rtron.vocabulary import Plan, Settings

_MAX_PROBLEMS = 5


def check_settings(effective: EffectivePlan) -> None:
    """Raise InputError with what is wrong with a plan under settings.

    What is wrong with the plan itself, without settings, is not held against them.
    """
    problems = [*((text, "") for text in effective.problems()), *_expression_problems(effective)]
    if problems:
        (message, help), *others = problems[:_MAX_PROBLEMS]
        raise InputError("; ".join([message, *(text for text, _ in others)]), help=help)


def drop_misfits(plan: Plan, settings: Settings) -> tuple[Settings, tuple[str, ...]]:
    """Return what is left of settings under another plan, and what had to be left out and why."""
    remaining, dropped = compatible_settings(plan, settings)
    for id, node in tuple(remaining.nodes.items()):
        if reason := _rejection(EffectivePlan(plan, Settings(nodes={id: node}))):
            others = {i: each for i, each in remaining.nodes.items() if i != id}
            remaining = replace(remaining, nodes=others)
            dropped += (reason,)
    if reason := _rejection(EffectivePlan(plan, remaining)):
        return replace(remaining, nodes={}), (*dropped, reason)
    return remaining, dropped


def _rejection(effective: EffectivePlan) -> str:
    try:
        check_settings(effective)
    except InputError as error:
        return str(error)
    return "; ".join(mandatory_violations(effective))


def _expression_problems(effective: EffectivePlan) -> Iterator[tuple[str, str]]:
    """Yield what the settings make wrong with the expressions of the mission's rules."""
    base, plan = effective.base, effective.plan
    if base.msrcn == plan.msrcn or not has_expressions(plan):
        return
    from rtron.planning.expressions import expression_problems  # noqa: PLC0415 - seldom needed

    found = {str(error): error.help for _, _, error in expression_problems(plan)}
    known = {str(error) for _, _, error in expression_problems(base)} if found else set()
    yield from ((text, help) for text, help in found.items() if text not in known)

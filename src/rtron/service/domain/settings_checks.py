"""Whether settings may go out: the plan that they make must pass what `rtron check` asks."""

from collections.abc import Iterator
from dataclasses import replace

from rtron.errors import InputError
from rtron.planning.coherence import coherence_problems
from rtron.planning.plan_file.loader import has_expressions
from rtron.service.domain.rights import mandatory_violations
from rtron.vocabulary import (
    Plan,
    Settings,
    SettingsMismatchError,
    apply_settings,
    compatible_settings,
)
from rtron.vocabulary.settings_validation import apply_valid_settings

_MAX_PROBLEMS = 5


def effective_plan(plan: Plan, settings: Settings) -> Plan:
    """Return the plan in force under settings; InputError if they name what it does not have."""
    try:
        return apply_settings(plan, settings)
    except SettingsMismatchError as error:
        raise InputError(str(error)) from None


def check_settings(plan: Plan, settings: Settings) -> Plan:
    """Return the plan in force under settings; InputError with what is wrong with it.

    What is wrong with the plan itself, without settings, is not held against them.
    """
    after = effective_plan(plan, settings)
    problems = _new_problems(plan, after)
    if problems:
        (message, help), *others = problems[:_MAX_PROBLEMS]
        raise InputError("; ".join([message, *(text for text, _ in others)]), help=help)
    _check_in_force(plan, settings)
    return after


def drop_misfits(plan: Plan, settings: Settings) -> tuple[Settings, tuple[str, ...]]:
    """Return what is left of settings under another plan, and what had to be left out and why."""
    kept_settings, dropped = compatible_settings(plan, settings)
    for id in tuple(kept_settings.nodes):
        node_settings = Settings(nodes={id: kept_settings.nodes[id]})
        if reason := _rejection(plan, node_settings):
            kept_settings = replace(
                kept_settings, nodes={i: node for i, node in kept_settings.nodes.items() if i != id}
            )
            dropped += (reason,)
    if reason := _rejection(plan, kept_settings):
        return replace(kept_settings, nodes={}), (*dropped, reason)
    return kept_settings, dropped


def _check_in_force(plan: Plan, settings: Settings) -> None:
    """Raise InputError for what the guard itself would refuse."""
    try:
        apply_valid_settings(plan, settings)
    except SettingsMismatchError as error:
        raise InputError(str(error)) from None


def _rejection(plan: Plan, settings: Settings) -> str:
    try:
        check_settings(plan, settings)
    except InputError as error:
        return str(error)
    return "; ".join(mandatory_violations(plan, settings))


def _new_problems(plan: Plan, after: Plan) -> list[tuple[str, str]]:
    """Return what is wrong with `after` and was not with `plan`; expressions if they may differ."""
    rules_differ = plan.msrcn != after.msrcn
    problems = dict.fromkeys(_problems(after, expressions=rules_differ))
    known_problems = set(_problems(plan, expressions=rules_differ)) if problems else set()
    return [problem for problem in problems if problem not in known_problems]


def _problems(plan: Plan, *, expressions: bool) -> Iterator[tuple[str, str]]:
    """Yield what is wrong with a plan, and what to do about it."""
    for _, _, message in coherence_problems(plan):
        yield message, ""
    if expressions and has_expressions(plan):
        from rtron.planning.expressions import expression_problems  # noqa: PLC0415 - seldom needed

        for _, _, error in expression_problems(plan):
            yield str(error), error.help

"""The plan file `rtron.yaml`, read and checked as a whole before anything uses it."""

from collections.abc import Iterable, Mapping
from pathlib import Path

from rtron.coherence import coherence_problems
from rtron.errors import InputError
from rtron.planning.plan_file.decoder import PlanDecoder
from rtron.planning.plan_file.problems import FileProblems
from rtron.planning.plan_file.yaml_parser import parse_yaml, read_text
from rtron.vocabulary import Plan

_NO_DEFINITIONS: Mapping[str, str] = {}


def read_plan(path: Path, recorded_definitions: Mapping[str, str] = _NO_DEFINITIONS) -> Plan:
    """Read a plan; raise one PlanError that tells all that is wrong, each with file and line.

    `recorded_definitions` are definitions by their types, which a recording brings: in a plan for
    ROS 2 those count that its expressions need and that nothing else defines.
    """
    return parse_plan(read_text(path), str(path), recorded_definitions)


def parse_plan(
    text: str, path: str = "rtron.yaml", recorded_definitions: Mapping[str, str] = _NO_DEFINITIONS
) -> Plan:
    """Read a plan from its text; `path` is what the errors call it."""
    problems = FileProblems(path)
    decoder = PlanDecoder(problems)
    plan = decoder.decode(parse_yaml(text, path), Plan) or Plan(app="")
    if recorded_definitions and plan.ros != 1 and has_expressions(plan):
        plan = _with_recorded_definitions(plan, recorded_definitions)
    for part, key, message in coherence_problems(plan):
        problems.add(decoder.line(part, key), message)
    for part, key, error in _expression_problems(plan):
        problems.add(decoder.line(part, key), str(error), error.help)
    problems.raise_if_any()
    return plan


def has_expressions(plan: Plan) -> bool:
    """Tell whether a plan has expressions, or definitions for them."""
    events = plan.msrcn.eflows if plan.msrcn else ()
    rules = plan.msrcn.rules if plan.msrcn else ()
    return bool(plan.messages or rules or any(flow.when for flow in events))


def _expression_problems(plan: Plan) -> Iterable[tuple[object, str, InputError]]:
    if not has_expressions(plan):
        return ()
    from rtron.planning.expressions import expression_problems  # noqa: PLC0415 - seldom needed

    return expression_problems(plan)


def _with_recorded_definitions(plan: Plan, definitions: Mapping[str, str]) -> Plan:
    from rtron.planning.expressions import with_recorded_definitions  # noqa: PLC0415 - only a replay needs it

    return with_recorded_definitions(plan, definitions)

"""The plan file `rtron.yaml`, read and checked as a whole before anything uses it."""

from collections.abc import Iterable, Mapping
from pathlib import Path

from rtron.errors import InputError
from rtron.planning.coherence import misfits
from rtron.planning.plan_file.decoder import Reader
from rtron.planning.plan_file.problems import Faults
from rtron.planning.plan_file.yaml_parser import compose, read_text
from rtron.vocabulary import Plan

_NOTHING: Mapping[str, str] = {}


def read_plan(path: Path, recorded: Mapping[str, str] = _NOTHING) -> Plan:
    """Read a plan; raise one PlanError that tells all that is wrong, each with file and line.

    `recorded` are definitions by their types, which a recording brings: in a plan for ROS 2 those
    count that its expressions need and that nothing else defines.
    """
    return parse_plan(read_text(path), str(path), recorded)


def parse_plan(text: str, path: str = "rtron.yaml", recorded: Mapping[str, str] = _NOTHING) -> Plan:
    """Read a plan from its text; `path` is what the errors call it."""
    faults = Faults(path)
    reader = Reader(faults)
    plan = reader.noun(compose(text, path), Plan) or Plan(app="")
    if recorded and plan.ros != 1 and has_expressions(plan):
        plan = _with_recorded(plan, recorded)
    for noun, key, message in misfits(plan):
        faults.add(reader.line(noun, key), message)
    for noun, key, error in _expression_faults(plan):
        faults.add(reader.line(noun, key), str(error), error.help)
    faults.raise_if_any()
    return plan


def has_expressions(plan: Plan) -> bool:
    """Tell whether a plan has expressions, or definitions for them."""
    events = plan.msrcn.eflows if plan.msrcn else ()
    rules = plan.msrcn.rules if plan.msrcn else ()
    return bool(plan.messages or rules or any(flow.when for flow in events))


def _expression_faults(plan: Plan) -> Iterable[tuple[object, str, InputError]]:
    if not has_expressions(plan):
        return ()
    from rtron.planning.expressions import expression_faults  # noqa: PLC0415 - seldom needed

    return expression_faults(plan)


def _with_recorded(plan: Plan, recorded: Mapping[str, str]) -> Plan:
    from rtron.planning.recorded import with_recorded  # noqa: PLC0415 - only a replay needs it

    return with_recorded(plan, recorded)

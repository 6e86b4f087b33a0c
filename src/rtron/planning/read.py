"""The plan file `rtron.yaml`, read and checked as a whole before anything uses it."""

from pathlib import Path

from rtron.planning.coherence import misfits
from rtron.planning.faults import Faults
from rtron.planning.reader import Reader
from rtron.planning.yaml_text import compose, read_text
from rtron.vocabulary import Plan


def read_plan(path: Path) -> Plan:
    """Read a plan; raise one PlanError that tells all that is wrong, each with file and line."""
    return parse_plan(read_text(path), str(path))


def parse_plan(text: str, path: str = "rtron.yaml") -> Plan:
    """Read a plan from its text; `path` is what the errors call it."""
    faults = Faults(path)
    reader = Reader(faults)
    plan = reader.noun(compose(text, path), Plan) or Plan(app="")
    for noun, key, message in misfits(plan):
        faults.add(reader.line(noun, key), message)
    faults.raise_if_any()
    return plan

"""Planning (paper section 6.2): from risks to a plan, its file, and whether it fits an app."""

from rtron.planning.check import check_plan
from rtron.planning.problem import Level, Problem
from rtron.planning.propose import left_out, propose_plan
from rtron.planning.read import parse_plan, read_plan
from rtron.planning.schema import plan_json_schema
from rtron.planning.write import write_plan

__all__ = [
    "Level",
    "Problem",
    "check_plan",
    "left_out",
    "parse_plan",
    "plan_json_schema",
    "propose_plan",
    "read_plan",
    "write_plan",
]

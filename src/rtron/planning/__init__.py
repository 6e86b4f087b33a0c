"""Planning (paper section 6.2): from risks to a plan, its file, and whether it fits an app."""

from rtron.planning.app_check import check_plan
from rtron.planning.plan_file.json_schema import plan_json_schema
from rtron.planning.plan_file.loader import parse_plan, read_plan
from rtron.planning.plan_file.writer import write_plan
from rtron.planning.problem import PlanProblem, ProblemLevel
from rtron.planning.proposal.policy_defaults import propose_plan, unguardable_topics

__all__ = [
    "PlanProblem",
    "ProblemLevel",
    "check_plan",
    "parse_plan",
    "plan_json_schema",
    "propose_plan",
    "read_plan",
    "unguardable_topics",
    "write_plan",
]

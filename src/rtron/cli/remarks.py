"""The planner's problems as the remarks that a report shows."""

from collections.abc import Iterable

from rtron.planning.problem import PlanProblem
from rtron.reports.problems_text import Remark


def to_remarks(problems: Iterable[PlanProblem]) -> list[Remark]:
    """Return a remark for each problem."""
    return [Remark(problem.level, problem.location, problem.message) for problem in problems]

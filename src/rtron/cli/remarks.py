"""The planner's problems as the remarks that a report shows."""

from collections.abc import Iterable

from rtron.planning.problem import Problem
from rtron.reports.plan.problems import Remark


def remarks_of(problems: Iterable[Problem]) -> list[Remark]:
    """Return a remark for each problem."""
    return [Remark(problem.level, problem.where, problem.message) for problem in problems]

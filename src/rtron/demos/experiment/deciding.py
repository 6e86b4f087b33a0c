"""Which worlds can share a guarded app: those in which the same is decided."""

from collections.abc import Callable, Sequence

from rtron.demos.cases import Case, Decisions, RunConditions
from rtron.demos.cases.together import merge_decisions


def worlds_by_decisions(
    cases: Sequence[Case], seeds: Sequence[int], setting: Callable[[Case, int], RunConditions]
) -> Sequence[tuple[Decisions, Sequence[int]]]:
    """Return decisions against all cases, each with the seeds of the worlds in a row it is for."""
    found: list[tuple[Decisions, list[int]]] = []
    for seed in seeds:
        decisions = merge_decisions(case.decisions(setting(case, seed)) for case in cases)
        if not found or found[-1][0] != decisions:
            found.append((decisions, []))
        found[-1][1].append(seed)
    return found

"""Which worlds of a case can share a guarded app: those in which the same is decided."""

from collections.abc import Mapping, Sequence

from rtron.demos.cases import Case, Decisions, Setting


def by_decisions(
    case: Case, settings: Mapping[int, Setting]
) -> Sequence[tuple[Decisions, Sequence[int]]]:
    """Return decisions, each with the seeds of the worlds in a row that they are for."""
    found: list[tuple[Decisions, list[int]]] = []
    for seed, setting in settings.items():
        decisions = case.decisions(setting)
        if not found or found[-1][0] != decisions:
            found.append((decisions, []))
        found[-1][1].append(seed)
    return found

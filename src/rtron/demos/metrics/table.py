"""The table of a case: the same world without an attack, attacked, and attacked with the guard."""

from collections.abc import Callable, Iterable, Mapping, Sequence

from rtron.demos.metrics.case_run import NEVER, NOTHING, CaseRun, Variant

Column = Sequence[CaseRun]
"""The runs of one variant, in any number of worlds."""
COLUMN_TITLES = {
    Variant.UNATTACKED: "no attack",
    Variant.ATTACKED: "attacked, no guard",
    Variant.GUARDED: "attacked, guarded",
}
_NONE = "-"


def columns(runs: Iterable[CaseRun]) -> Mapping[Variant, Column]:
    """Return the runs by variant, in the order of variants; those that were not made are absent."""
    all_runs = list(runs)
    found = {each: [run for run in all_runs if run.variant is each] for each in Variant}
    return {variant: column for variant, column in found.items() if column}


def cells(table: Mapping[Variant, Column]) -> list[tuple[str, list[str]]]:
    """Return the table's lines: a title, and a cell for each variant that was run."""
    return [(title, [cell(column) for column in table.values()]) for title, cell in _ROWS.items()]


def _outcome(column: Column) -> str:
    if len(column) == 1:
        return column[0].outcome
    names = dict.fromkeys(run.outcome for run in column)
    counts = {name: sum(run.outcome == name for run in column) for name in names}
    return ", ".join(f"{count} x {name}" for name, count in counts.items())


def _collided(column: Column) -> str:
    hits = sum(run.collided for run in column)
    if len(column) == 1:
        return "yes" if hits else "no"
    return f"{hits} of {len(column)}"


def _sent(column: Column) -> str:
    attacked = [run for run in column if run.is_attacked]
    if not attacked:
        return _NONE
    return f"{sum(run.sent for run in attacked)} / {sum(run.delivered for run in attacked)}"


def _mitigated(column: Column) -> str:
    found = {run.mitigation for run in column}
    if NEVER in found or "" in found:
        return NEVER if NEVER in found else _NONE
    times = [run.mitigated_after for run in column if run.mitigated_after is not None]
    texts = [f"{max(times) * 1000:.1f} ms"] if times else []
    return ", ".join(texts + [NOTHING] * (NOTHING in found))


def _deviation(column: Column) -> str:
    found = [run.deviation for run in column if run.is_attacked and run.deviation]
    if not found:
        return _NONE
    mean = sum(each.mean for each in found) / len(found)
    return f"{max(each.largest for each in found):.2f} m / {mean:.2f} m"


def _time(column: Column) -> str:
    times = [run.time_to_goal for run in column if run.time_to_goal is not None]
    if len(times) < len(column):
        return _NONE if len(column) == 1 else f"{len(times)} of {len(column)} arrive"
    least, most = min(times), max(times)
    return f"{most:.1f} s" if len(times) == 1 else f"{least:.1f} to {most:.1f} s"


_ROWS: dict[str, Callable[[Column], str]] = {
    "outcome": _outcome,
    "collision": _collided,
    "malicious messages sent / delivered": _sent,
    "stopped after, at most": _mitigated,
    "off the way, at most / mean": _deviation,
    "time to the goal (simulated)": _time,
}

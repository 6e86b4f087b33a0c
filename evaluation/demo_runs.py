"""All runs of the case studies as a page."""

from collections.abc import Iterator, Mapping, Sequence

from rtron.demos.experiment.adaptation import SlowdownResult
from rtron.demos.metrics.case_run import CaseRun, Variant

_HEAD = """\
# The case studies, run by run

`python -m evaluation demos` made these: every case in twenty worlds, in which start, goal, widths,
obstacles and the pedestrian's moment differ. Times are simulated seconds. The attack is `stopped`
where a verdict of the guard tells when; a flow that was blocked before gets no new one, and
`nothing arrived` is all that is to be told. `off` is the largest distance from the unattacked way.
"""
_COLUMNS = (
    "world | unattacked | attacked | collided | sent / delivered | guarded | time | "
    "sent / delivered | the attack | off"
)
_RULE = "--:|--:|---|---|--:|---|--:|--:|--:|--:"


def runs_page(runs: Sequence[CaseRun], slowed: Mapping[int, Sequence[SlowdownResult]]) -> str:
    """Return the page of all runs and adaptations."""
    return "\n".join((_HEAD, *_parts(runs), *_slowed(slowed))) + "\n"


def _parts(runs: Sequence[CaseRun]) -> Iterator[str]:
    for ros, case in dict.fromkeys((run.ros, run.case) for run in runs):
        case_runs = [run for run in runs if (run.ros, run.case) == (ros, case)]
        yield f"## {case.upper()} on ROS {ros}, at {case_runs[0].speed:g} simulated seconds a second\n"
        yield f"| {_COLUMNS} |\n|{_RULE}|"
        for seed in dict.fromkeys(run.seed for run in case_runs):
            yield _line({run.variant: run for run in case_runs if run.seed == seed})
        yield ""


def _line(runs: Mapping[Variant, CaseRun]) -> str:
    reference, attacked, guarded = (runs[variant] for variant in Variant)
    off = f"{guarded.deviation.largest:.2f} m" if guarded.deviation else ""
    cells = (
        str(reference.seed),
        _time(reference.time_to_goal),
        attacked.outcome,
        "yes" if attacked.collided else "no",
        f"{attacked.sent} / {attacked.delivered}",
        guarded.outcome,
        _time(guarded.time_to_goal),
        f"{guarded.sent} / {guarded.delivered}",
        guarded.mitigation,
        off,
    )
    return f"| {' | '.join(cells)} |"


def _time(seconds: float | None) -> str:
    return "-" if seconds is None else f"{seconds:.1f} s"


def _slowed(slowed: Mapping[int, Sequence[SlowdownResult]]) -> Iterator[str]:
    for ros, found in slowed.items():
        yield f"## Safe on ROS {ros}: how soon the robot adapts\n"
        yield "The recogniser's rate is halved, from 20 to 10 images a second, while the robot"
        yield "cruises at speed 1; wall seconds until it is as slow as it may be then (10 % more"
        yield "counts as that). The guard counts frames over 0.2 s; the case itself runs with 10"
        yield "images a second and a window of four of them, and so adapts later.\n"
        yield "| world | after | at most |\n|--:|--:|--:|"
        for each in found:
            after = "never" if each.after is None else f"{each.after:.2f} s"
            yield f"| {each.seed} | {after} | {each.allowed:.3f} m/s |"
        yield ""

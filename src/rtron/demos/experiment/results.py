"""What a demonstration leaves behind: pictures, figures as JSON, the plan, and a report."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml
from rich.text import Text

from rtron.demos.cases import Case
from rtron.demos.experiment.demonstration import Wish
from rtron.demos.experiment.results_folder import PLAN, REPORT, RESULTS, SCHEMA, clear, keep
from rtron.demos.experiment.study import Study
from rtron.demos.metrics.case_run import Variant
from rtron.demos.plots.html_report import Findings, Picture, Said, page
from rtron.demos.plots.timeline import timeline
from rtron.demos.plots.trajectories import trajectories
from rtron.demos.plots.velocity import velocity
from rtron.demos.runtime.processes import Finished

_INDENT = 1
_SCALES = "The highest bar of each row is its own busiest second."


def document(wish: Wish, study: Study, *, whole: bool = False) -> dict[str, Any]:
    """Return what was found as plain JSON, with every moment of each run if it is to be `whole`."""
    return {
        "schema": SCHEMA,
        "ros": wish.ros,
        "speed": wish.speed,
        "cases": [
            {
                "case": case.name,
                "risk": case.risk,
                "decisions": study.decisions.get(case.name),
                "runs": [run.as_json(whole=whole) for run in study.runs if run.case == case.name],
            }
            for case in wish.cases
        ],
    }


def write_results(out: Path, wish: Wish, study: Study) -> list[str]:
    """Write everything into the folder `out` in place of earlier results.

    Returns the names of the files, the report first.
    """
    clear(out)
    pictures = {case.name: list(_pictures(out, wish, case, study)) for case in wish.cases}
    parts = [
        (_findings(wish, case, study), [picture for _, picture in pictures[case.name]])
        for case in wish.cases
    ]
    commands = map(_said, study.said)
    (out / REPORT).write_text(page(parts, commands), encoding="utf-8")
    found = json.dumps(document(wish, study, whole=True), indent=_INDENT)
    (out / RESULTS).write_text(found + "\n", encoding="utf-8")
    keep(study.pipeline.folder, out)
    shown = [name for each in pictures.values() for name, _ in each]
    return [REPORT, RESULTS, *shown, *_plan(out, study)]


def _pictures(out: Path, wish: Wish, case: Case, study: Study) -> Iterator[tuple[str, Picture]]:
    """Draw the runs of a case in the first world."""
    seed = wish.seeds[0]
    scene, runs = study.scenes[case.name, seed], study.runs_of(case.name, seed)
    where = f"{case.name.upper()}, ROS {wish.ros}, world {seed}"
    ways, speeds = f"{case.name}-trajectories.png", f"{case.name}-velocity.png"
    trajectories(out / ways, f"{where}: where the robot went", scene, runs)
    yield ways, _picture(out / ways, f"Where the robot went ({where}).")
    velocity(out / speeds, f"{where}: how fast it was", scene, runs, turn=case.turns)
    yield speeds, _picture(out / speeds, f"How fast the robot was ({where}).")
    if guarded := runs.get(Variant.GUARDED):
        decided = f"{case.name}-verdicts.png"
        title = f"{where}: what the guard decided"
        timeline(out / decided, title, guarded, [case.topic])
        told = f"What the guard decided, second by second of the clock ({where}). {_SCALES}"
        yield decided, _picture(out / decided, told)


def _picture(path: Path, caption: str) -> Picture:
    return Picture(path.read_bytes(), caption)


def _findings(wish: Wish, case: Case, study: Study) -> Findings:
    decisions = study.decisions.get(case.name)
    return Findings(
        case=case,
        ros=wish.ros,
        runs=[run for run in study.runs if run.case == case.name],
        decisions=_yaml(decisions) if decisions else "",
    )


def _said(command: Finished) -> Said:
    return Said(command.command, Text.from_ansi(command.text).plain)


def _yaml(decisions: object) -> str:
    """Return decisions as YAML, without anchors where the same thing occurs twice."""
    plain = json.loads(json.dumps(decisions))
    return str(yaml.safe_dump(plain, sort_keys=False))


def _plan(out: Path, study: Study) -> Iterator[str]:
    if study.plan:
        (out / PLAN).write_text(study.plan, encoding="utf-8")
        yield PLAN

"""What a demonstration leaves behind: pictures, figures as JSON, the plan, and a report."""

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

from rtron.demos.cases import Case
from rtron.demos.experiment.demonstration import DemoRequest
from rtron.demos.experiment.results_folder import (
    PLAN,
    REPORT,
    RESULTS,
    SCHEMA,
    copy_artifacts,
    remove_earlier_results,
)
from rtron.demos.experiment.study import Study
from rtron.demos.metrics.case_run import Variant
from rtron.demos.plots.html_report import CaseFindings, Picture, render_report
from rtron.demos.plots.timeline import draw_timeline
from rtron.demos.plots.trajectories import draw_trajectories
from rtron.demos.plots.velocity import draw_velocity
from rtron.demos.runtime.plan_edits import plain_copy

_INDENT = 1
_SCALES = "The highest bar of each row is its own busiest second."


def results_document(
    request: DemoRequest, study: Study, *, with_samples: bool = False
) -> dict[str, Any]:
    """Return the results as plain JSON; `with_samples` adds every moment of each run."""
    return {
        "schema": SCHEMA,
        "ros": request.ros,
        "speed": request.speed,
        "cases": [
            {
                "case": case.name,
                "risk": case.risk,
                "decisions": study.decisions.get(case.name),
                "without_guard": study.without_guard(case.name),
                "runs": [
                    run.as_json(with_samples=with_samples)
                    for run in study.runs
                    if run.case == case.name
                ],
            }
            for case in request.cases
        ],
    }


def write_results(out: Path, request: DemoRequest, study: Study) -> list[str]:
    """Write everything into the folder `out` in place of earlier results.

    Returns the names of the files, the report first.
    """
    remove_earlier_results(out)
    cases = [_findings(out, request, case, study) for case in request.cases]
    (out / REPORT).write_text(render_report(cases, study.commands), encoding="utf-8")
    found = json.dumps(results_document(request, study, with_samples=True), indent=_INDENT)
    (out / RESULTS).write_text(found + "\n", encoding="utf-8")
    copy_artifacts(study.pipeline.folder, out)
    shown = [picture.path.name for each in cases for picture in each.pictures]
    return [REPORT, RESULTS, *shown, *_plan(out, study)]


def _findings(out: Path, request: DemoRequest, case: Case, study: Study) -> CaseFindings:
    decisions = study.decisions.get(case.name)
    return CaseFindings(
        case=case,
        ros=request.ros,
        runs=[run for run in study.runs if run.case == case.name],
        decisions=yaml.safe_dump(plain_copy(decisions), sort_keys=False) if decisions else "",
        pictures=list(_pictures(out, request, case, study)),
    )


def _pictures(out: Path, request: DemoRequest, case: Case, study: Study) -> Iterator[Picture]:
    """Draw the runs of a case in the first world."""
    seed = request.seeds[0]
    scene, runs = study.scenes[case.name, seed], study.runs_of(case.name, seed)
    where = f"{case.name.upper()}, ROS {request.ros}, world {seed}"

    trajectories = out / f"{case.name}-trajectories.png"
    draw_trajectories(trajectories, f"{where}: where the robot went", scene, runs)
    yield Picture(trajectories, f"Where the robot went ({where}).")

    velocity = out / f"{case.name}-velocity.png"
    draw_velocity(velocity, f"{where}: how fast it was", runs, turn=case.shows_turn_rate)
    yield Picture(velocity, f"How fast the robot was ({where}).")

    if guarded := runs.get(Variant.GUARDED):
        verdicts = out / f"{case.name}-verdicts.png"
        draw_timeline(verdicts, f"{where}: what the guard decided", guarded, [case.topic])
        caption = f"What the guard decided, second by second of the clock ({where}). {_SCALES}"
        yield Picture(verdicts, caption)
    if incident := study.incidents.get((case.name, seed)):
        drawn = out / f"{case.name}-incident.png"
        incident.draw(drawn)
        shutil.copy(incident.path, drawn.with_suffix(".mcap"))
        caption = f"The incident, and what would have been without the guard ({where}). "
        yield Picture(drawn, caption + incident.sentence)


def _plan(out: Path, study: Study) -> Iterator[str]:
    if study.plan:
        (out / PLAN).write_text(study.plan, encoding="utf-8")
        yield PLAN

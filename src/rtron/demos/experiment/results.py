"""What a demonstration leaves behind: pictures, figures as JSON, the plan, and a report."""

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml
from rich.text import Text

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
from rtron.demos.plots.html_report import CaseFindings, CommandOutput, Picture, render_report
from rtron.demos.plots.timeline import draw_timeline
from rtron.demos.plots.trajectories import draw_trajectories
from rtron.demos.plots.velocity import draw_velocity
from rtron.demos.runtime.plan_edits import plain_copy
from rtron.demos.runtime.processes import CompletedCommand

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
    pictures = {case.name: list(_pictures(out, request, case, study)) for case in request.cases}
    parts = [
        (_findings(request, case, study), [picture for _, picture in pictures[case.name]])
        for case in request.cases
    ]
    commands = map(_command_output, study.commands)
    (out / REPORT).write_text(render_report(parts, commands), encoding="utf-8")
    found = json.dumps(results_document(request, study, with_samples=True), indent=_INDENT)
    (out / RESULTS).write_text(found + "\n", encoding="utf-8")
    copy_artifacts(study.pipeline.folder, out)
    shown = [name for each in pictures.values() for name, _ in each]
    return [REPORT, RESULTS, *shown, *_plan(out, study)]


def _pictures(
    out: Path, request: DemoRequest, case: Case, study: Study
) -> Iterator[tuple[str, Picture]]:
    """Draw the runs of a case in the first world."""
    seed = request.seeds[0]
    scene, runs = study.scenes[case.name, seed], study.runs_of(case.name, seed)
    where = f"{case.name.upper()}, ROS {request.ros}, world {seed}"
    trajectories_file, velocity_file = f"{case.name}-trajectories.png", f"{case.name}-velocity.png"
    draw_trajectories(out / trajectories_file, f"{where}: where the robot went", scene, runs)
    yield trajectories_file, _picture(out / trajectories_file, f"Where the robot went ({where}).")
    title = f"{where}: how fast it was"
    draw_velocity(out / velocity_file, title, runs, turn=case.shows_turn_rate)
    yield velocity_file, _picture(out / velocity_file, f"How fast the robot was ({where}).")
    if guarded := runs.get(Variant.GUARDED):
        verdicts_file = f"{case.name}-verdicts.png"
        title = f"{where}: what the guard decided"
        draw_timeline(out / verdicts_file, title, guarded, [case.topic])
        caption = f"What the guard decided, second by second of the clock ({where}). {_SCALES}"
        yield verdicts_file, _picture(out / verdicts_file, caption)
    if incident := study.incidents.get((case.name, seed)):
        incident_file = f"{case.name}-incident.png"
        incident.draw(out / incident_file)
        shutil.copy(incident.path, out / f"{case.name}-incident.mcap")
        caption = f"The incident, and what would have been without the guard ({where}). "
        yield incident_file, _picture(out / incident_file, caption + incident.sentence)


def _picture(path: Path, caption: str) -> Picture:
    return Picture(path.read_bytes(), caption)


def _findings(request: DemoRequest, case: Case, study: Study) -> CaseFindings:
    decisions = study.decisions.get(case.name)
    return CaseFindings(
        case=case,
        ros=request.ros,
        runs=[run for run in study.runs if run.case == case.name],
        decisions=yaml.safe_dump(plain_copy(decisions), sort_keys=False) if decisions else "",
    )


def _command_output(command: CompletedCommand) -> CommandOutput:
    return CommandOutput(command.command, Text.from_ansi(command.text).plain)


def _plan(out: Path, study: Study) -> Iterator[str]:
    if study.plan:
        (out / PLAN).write_text(study.plan, encoding="utf-8")
        yield PLAN

"""What a demonstration leaves behind: pictures, figures as JSON, the plan, and a report."""

import json
import re
import shutil
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any

import yaml

from rtron.demos.cases import CASES, Case
from rtron.demos.experiment.demonstration import DemoRequest
from rtron.demos.experiment.study import Study
from rtron.demos.metrics.case_run import Variant
from rtron.demos.plots.html_report import CaseFindings, Picture, render_report
from rtron.demos.plots.timeline import draw_timeline
from rtron.demos.plots.trajectories import draw_trajectories
from rtron.demos.plots.velocity import draw_velocity
from rtron.demos.runtime.instrumentation import plain_copy
from rtron.demos.world.scenes.generator import make_scene
from rtron.errors import InputError

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
    scene, runs = make_scene(case.name, seed), study.runs_of(case.name, seed)
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


SCHEMA = "rtron.demo/1"
RESULTS = "results.json"
REPORT = "report.html"
PLAN = "rtron.yaml"
LOG = "log"
_COPIED = ("graph.json", "proposed.yaml", "bridge.yaml", LOG)
_OF_A_CASE = ("trajectories.png", "velocity.png", "verdicts.png", "incident.png", "incident.mcap")
_RESULTS_HEAD = re.compile(r'\s*\{\s*"schema":\s*"rtron\.demo/')
_HEAD = 200
_HELP = "choose a folder with -o"


def prepare_results_folder(out: Path) -> Path:
    """Return the folder for the results, made if it is not there.

    InputError if it cannot be made or written to, or if it has files that are no earlier results.
    """
    try:
        out.mkdir(parents=True, exist_ok=True)
        is_empty = not any(out.iterdir())
        with TemporaryFile(dir=out):
            pass
    except FileExistsError:
        raise InputError("is no folder", path=str(out), help=_HELP) from None
    except OSError as error:
        raise InputError(error.strerror or "cannot be made", path=str(out), help=_HELP) from None
    if not is_empty and not _has_results(out):
        help = f"{_HELP} that is empty, new, or has the results of an earlier demo"
        raise InputError("holds other files", path=str(out), help=help)
    return out


def remove_earlier_results(out: Path) -> None:
    """Remove what an earlier demonstration has written, by its names; a link is not followed."""
    for path in (out / name for name in _artifact_names()):
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink(missing_ok=True)


def copy_artifacts(work: Path, out: Path, names: Sequence[str] = _COPIED) -> None:
    """Copy what is of use later from the folder of work."""
    for path in (work / name for name in names if (work / name).exists()):
        if path.is_dir():
            shutil.copytree(path, out / path.name)
        else:
            shutil.copy(path, out / path.name)


def copy_logs(work: Path, out: Path, error: str) -> Path | None:
    """Leave the logs of a demonstration that failed with `error`, in place of earlier results.

    Returns the folder that they are in; None if it failed before there were any.
    """
    if not (work / LOG).is_dir():
        return None
    remove_earlier_results(out)
    copy_artifacts(work, out, [LOG])
    (out / RESULTS).write_text(json.dumps({"schema": SCHEMA, "error": error}) + "\n")
    return out / LOG


def _has_results(out: Path) -> bool:
    results = out / RESULTS
    if not results.is_file():
        return False
    try:
        with results.open(encoding="utf-8") as file:
            return _RESULTS_HEAD.match(file.read(_HEAD)) is not None
    except (OSError, ValueError):
        return False


def _artifact_names() -> Iterator[str]:
    yield from (REPORT, RESULTS, PLAN, *_COPIED)
    for case in CASES:
        yield from (f"{case}-{name}" for name in _OF_A_CASE)

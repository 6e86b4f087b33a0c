"""`rtron verify`."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated

import typer
from rich.text import Text

from rtron.cli.support.options import (
    DEFAULT_MASTER,
    DEFAULT_TIMEOUT,
    Domain,
    Master,
    TextOrJson,
    Timeout,
)
from rtron.cli.support.outcome import BAD_INPUT, FINDINGS, OK, Outcome, as_json
from rtron.errors import InputError
from rtron.guard.audit.common.verification import GuardedPath, PathState, Verification
from rtron.planning.plan_file.loader import read_plan
from rtron.reports.text_layout import Report, TextPage, columns, counted, heading, line, paragraph
from rtron.workflows.verify import verify_running_app

VERIFY_SCHEMA = "rtron.verify/1"
_STYLES = {
    PathState.CLOSED: "green",
    PathState.OPEN: "bold red",
    PathState.DRIFT: "bold red",
    PathState.UNKNOWN: "yellow",
    PathState.NOT_RUNNING: "dim",
}


def verification_text(title: str, verification: Verification) -> Report:
    """Return a report: the verdict, the paths with their problems, and unguarded interfaces."""
    return Report(lambda page: _lines(title, verification, page))


def verification_to_json(verification: Verification) -> Mapping[str, object]:
    """Return the JSON document: the verdict, paths, problems and unguarded interfaces."""
    return {
        "schema": VERIFY_SCHEMA,
        "verdict": verdict(verification),
        "paths": [
            {
                "topic": path.topic,
                "private": path.private,
                "node": path.node,
                "state": str(path.state),
                "reason": path.reason,
                "foreign": list(path.foreign),
            }
            for path in verification.paths
        ],
        "problems": list(verification.problems),
        "unguarded": [{"what": each.what, "why": each.why} for each in verification.unguarded],
    }


def verdict(verification: Verification) -> str:
    """Return the verdict: closed, open or unknown."""
    if verification.is_closed:
        return "closed"
    return "open" if verification.is_conclusive else "unknown"


def _lines(title: str, verification: Verification, page: TextPage) -> Iterator[Text]:
    verdict_text = verdict(verification)
    yield line(
        (title, "bold"),
        "  ",
        (verdict_text, "bold green" if verification.is_closed else "bold red"),
    )
    for problem in verification.problems:
        yield from paragraph(problem, page, indent=2, style="red")
    yield from heading(counted(len(verification.paths), "planned path"))
    rows = [(str(path.state), path.node, path.private) for path in verification.paths]
    for path, row in zip(verification.paths, columns(rows, indent=2) if rows else [], strict=True):
        row.stylize(_STYLES[path.state], 2, 2 + len(str(path.state)))
        yield row
        yield from _why(path, page)
    if verification.unguarded:
        yield from heading("Not guarded")
        for each in verification.unguarded:
            yield line((each.what, "cyan"), f"  {each.why}", indent=2)


def _why(path: GuardedPath, page: TextPage) -> Iterator[Text]:
    if path.reason:
        yield from paragraph(path.reason, page, indent=15)


Live = Annotated[bool, typer.Option("--live", help="Verify the running app.")]


def verify(
    *,
    live: Live = False,
    plan: Annotated[
        Path, typer.Option("--plan", metavar="rtron.yaml", help="The plan of the guarded app.")
    ] = Path("rtron.yaml"),
    master: Master = DEFAULT_MASTER,
    domain: Domain = None,
    timeout: Timeout = DEFAULT_TIMEOUT,
    format: Annotated[TextOrJson, typer.Option(help="A table, or JSON.")] = TextOrJson.TEXT,
) -> Outcome:
    """Check that all guarded traffic of the running app passes through the guard.

    In ROS 1 it asks every guarded node for its connections, because a
    publisher that never registered shows nowhere else. In ROS 2 it reads the
    endpoints of the domain and their participants; `--timeout` is how long
    discovery may take. States of the paths of the plan:

    closed        the node receives from the guard only, on the private topic
    open          the node also receives from another publisher, which is named
    drift         the node uses the public name: its remap is missing
    unknown       the node runs and does not answer
    not running   the node is not there

    $ rtron verify --live
    $ rtron verify --live --plan rtron.yaml --master http://robot:11311
    $ rtron verify --live --domain 7                a plan that says `ros: 2`
    $ rtron verify --live --format json | jq .verdict

    It changes nothing; in ROS 2 it joins the domain as /rtron_verify. The
    running guard checks the same continuously; see `audit` in the plan.

    Exit code: 0 closed, 1 open or drifted, 2 unknown.
    """
    if not live:
        help = "add --live; before the app runs, `rtron check` compares the plan with its graph"
        raise InputError("what is there to verify?", help=help)
    guard_plan = read_plan(plan)
    verification = verify_running_app(guard_plan, master, domain, timeout)
    code = OK if verification.is_closed else FINDINGS if verification.is_conclusive else BAD_INPUT
    if format is TextOrJson.JSON:
        return Outcome(as_json(verification_to_json(verification)), code)
    return Outcome(verification_text(str(plan), verification), code)

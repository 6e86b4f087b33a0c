"""`rtron rollout`."""

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rtron.cli.support.options import TextOrJson
from rtron.cli.support.outcome import FINDINGS, OK, Outcome, as_json, print_part
from rtron.cli.support.rollout_report import (
    PROBLEMS,
    has_failed,
    parse_limits,
    parse_stages,
    rollout_line,
)
from rtron.cli.support.service_options import calls_service
from rtron.cli.support.settings_arguments import complete_setting, parse_patch
from rtron.errors import InputError

if TYPE_CHECKING:
    from rtron.workflows.rollouts import RolloutClient
    from rtron.workflows.service_client import SecurityServiceClient

rollout = typer.Typer(
    name="rollout", no_args_is_help=True, help="Change many robots in stages, and watch them."
)


def _complete_limit(incomplete: str) -> list[tuple[str, str]]:
    return [(f"{key}=", text) for key, text in PROBLEMS.items() if key.startswith(incomplete)]


Id = Annotated[int, typer.Argument(metavar="ID", min=1, help="The number of the roll-out.")]
Reason = Annotated[str, typer.Option(metavar="TEXT", help="The reason, for the audit log.")]
Follow = Annotated[
    bool, typer.Option("--follow", "-f", help="Show each step until the end; Ctrl-C ends this.")
]
Format = Annotated[TextOrJson, typer.Option(help="Text, or JSON.")]


@rollout.callback()
def rollout_group() -> None:
    """Change many robots in stages, through the security service, which watches them.

    First one robot gets the change, then 10 %, then all. When more robots than
    the limits allow show a problem, the change goes back by itself.
    """


@rollout.command()
@calls_service
def start(  # noqa: PLR0913 - one for each option
    client: "SecurityServiceClient",
    node: Annotated[
        str, typer.Argument(metavar="[NODE]", help="The coordination node: its `id`.")
    ] = "",
    assignments: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="KEY=VALUE...",
            help="The settings to change, as in `rtron settings set`.",
            autocompletion=complete_setting,
        ),
    ] = None,
    *,
    plan: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Another plan for the robots, instead of settings."),
    ] = None,
    group: Annotated[
        str | None, typer.Option(metavar="NAME", help="The robots of this group.")
    ] = None,
    app: Annotated[str | None, typer.Option(metavar="NAME", help="The robots of this app.")] = None,
    robot: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="A robot; can be repeated.")
    ] = None,
    reason: Reason,
    stages: Annotated[
        str,
        typer.Option(
            metavar="LIST", help="How many robots have the change after each stage; at last 100%."
        ),
    ] = "1,10%,100%",
    wait: Annotated[
        str, typer.Option(metavar="TIME", help="The time to watch before the next stage.")
    ] = "5 min",
    limit: Annotated[
        list[str] | None,
        typer.Option(
            metavar="PROBLEM=AMOUNT",
            help="So many robots may show it; can be repeated.  [default: 0; gone=5%]",
            autocompletion=_complete_limit,
        ),
    ] = None,
    blocked_rise: Annotated[
        float,
        typer.Option(min=0, max=1, metavar="SHARE", help="`blocked`: the share rises by more."),
    ] = 0.1,
    answer_within: Annotated[
        str, typer.Option(metavar="TIME", help="`gone`: away, or without an answer, for longer.")
    ] = "30 s",
    follow: Follow = False,
    format: Format = TextOrJson.TEXT,
) -> Outcome:
    r"""Begin a roll-out: one robot, then 10 %, then all.

    $ rtron rollout start speed max_vel_limit=0.3 --group hall-a --reason fair
    $ rtron rollout start drive policy=Block --app turtlebot3 --reason test \
          --stages 1,5,25%,100% --wait 10min --limit alarm=0 --limit gone=2% -f
    $ rtron rollout start --plan rtron.yaml --group hall-a --reason calmer

    A robot has a problem when, since it got the change, it is
      refused    the guard, or the service, did not take the change
      alarm      there was a new alarm
      blocked    more of its messages are blocked than before
      stopped    its guard, or a person, stopped it
      restarted  its guard began anew
      gone       its guard is away, or does not answer
    More robots with a problem than its limit: the change goes back by itself, on
    all robots that have it. Robots that are off get it when they come back.
    You need the rights to change each of the robots; a plan takes a developer,
    and guards that were started with `rtron guard --plans`.

    Exit code: 0 begun (with --follow: on all robots), 1 it did not stay on all
    robots, 2 nothing changed.
    """
    rollouts = _rollouts(client)
    robots = _selection(group, app, robot)
    new = {
        "robots": robots,
        **_change(rollouts, robots, node, assignments or [], plan),
        "reason": reason,
        "stages": parse_stages(stages),
        "wait": _seconds("--wait", wait),
        "limits": parse_limits(limit or ()),
        "blocked_rise": blocked_rise,
        "answer_within": _seconds("--answer-within", answer_within),
    }
    started = rollouts.start(new)
    return _follow(rollouts, started["id"], format) if follow else _one(started, format)


@rollout.command("list")
@calls_service
def list_rollouts(
    client: "SecurityServiceClient",
    *,
    number: Annotated[
        int, typer.Option("--number", "-n", min=1, max=200, help="The number of roll-outs.")
    ] = 20,
    format: Format = TextOrJson.TEXT,
) -> Outcome:
    """List the newest roll-outs, each with what it is at.

    $ rtron rollout list --token-file me.token
    $ rtron rollout list --format json | jq '.rollouts[].note'

    Exit code: 0 shown, 2 the service does not answer.
    """
    from rtron.cli.support.rollout_report import rollouts_report

    found = _rollouts(client).newest(number)
    is_json = format is TextOrJson.JSON
    return Outcome(as_json({"rollouts": found}) if is_json else rollouts_report(found))


@rollout.command()
@calls_service
def show(
    client: "SecurityServiceClient",
    id: Id,
    *,
    robots: Annotated[bool, typer.Option("--robots", help="With a line for each robot.")] = False,
    follow: Follow = False,
    format: Format = TextOrJson.TEXT,
) -> Outcome:
    """Show a roll-out: its stages, what is watched, and why it went back.

    $ rtron rollout show 3 --robots --token-file me.token
    $ rtron rollout show 3 --follow
    $ rtron rollout show 3 --robots --format json | jq '.robots[].problems'

    --follow prints a line for each step, in text or JSON, until the end.

    Exit code: 0 shown (with --follow: on all robots), 1 with --follow: it did
    not stay on all robots, 2 there is no such roll-out.
    """
    from rtron.cli.support.rollout_report import rollout_report

    rollouts = _rollouts(client)
    if follow:
        return _follow(rollouts, id, format)
    view = rollouts.view(id)
    found = list(rollouts.robots(id)) if robots else []
    if format is TextOrJson.JSON:
        return Outcome(as_json({**view, "robots": found} if robots else view))
    return Outcome(rollout_report(view, found))


@rollout.command()
@calls_service
def pause(
    client: "SecurityServiceClient", id: Id, *, reason: Reason, format: Format = TextOrJson.TEXT
) -> Outcome:
    """Let no further robot get the change; it still goes back at a limit.

    $ rtron rollout pause 3 --reason "the night shift looks at it first"

    Exit code: 0 paused, 2 not.
    """
    return _one(_rollouts(client).control(id, "pause", reason=reason), format)


@rollout.command()
@calls_service
def resume(
    client: "SecurityServiceClient", id: Id, *, reason: Reason, format: Format = TextOrJson.TEXT
) -> Outcome:
    """Go on with a roll-out that is paused.

    $ rtron rollout resume 3 --reason "all is well"

    It takes the rights to change each of its robots.

    Exit code: 0 it goes on, 2 it does not.
    """
    return _one(_rollouts(client).control(id, "resume", reason=reason), format)


@rollout.command()
@calls_service
def cancel(
    client: "SecurityServiceClient",
    id: Id,
    *,
    reason: Reason,
    keep: Annotated[
        bool, typer.Option("--keep", help="Leave the change on the robots that have it.")
    ] = False,
    format: Format = TextOrJson.TEXT,
) -> Outcome:
    """Take the change back from all robots, or end the roll-out with --keep.

    $ rtron rollout cancel 3 --reason "it brakes too early"
    $ rtron rollout cancel 3 --keep --reason "hall B stays as it is"

    What others have set since, overrides and stops stay. A roll-out that is
    done can be taken back, too.

    Exit code: 0 it goes back or has ended, 2 it does not.
    """
    rollouts = _rollouts(client)
    return _one(rollouts.control(id, "cancel", reason=reason, keep=keep), format)


def _rollouts(client: "SecurityServiceClient") -> "RolloutClient":
    from rtron.workflows.rollouts import RolloutClient

    return RolloutClient(client)


def _change(
    rollouts: "RolloutClient",
    robots: Mapping[str, Any],
    node: str,
    assignments: list[str],
    plan: Path | None,
) -> dict[str, Any]:
    """Return what goes out: settings of a node, or a plan."""
    from rtron.planning.plan_file.loader import read_text

    if (plan is None) == (not assignments) or (plan and node):
        raise InputError("what goes out?", help="give NODE KEY=VALUE..., or --plan FILE")
    if plan:
        return {"plan": read_text(plan)}
    planned = rollouts.planned_node(robots, node)
    patch = parse_patch(assignments, planned.flow_names, has_rules=planned.has_rules)
    return {"nodes": {node: patch}}


def _selection(group: str | None, app: str | None, names: list[str] | None) -> dict[str, Any]:
    given = {"label": group, "app": app, "names": names or None}
    robots = {key: value for key, value in given.items() if value is not None}
    if not robots or ("names" in robots and len(robots) > 1):
        help = "give --group, --app or both, or each --robot"
        raise InputError("which robots?", help=help)
    return robots


def _seconds(option: str, text: str) -> float:
    from rtron.planning.plan_file.quantities import parse_duration

    try:
        return parse_duration(text) / 1e9
    except ValueError as error:
        raise InputError(f"{option}: {error}") from None


def _one(view: Mapping[str, Any], format: TextOrJson) -> Outcome:
    return Outcome(as_json(view) if format is TextOrJson.JSON else rollout_line(view))


def _follow(rollouts: "RolloutClient", id: int, format: TextOrJson) -> Outcome:
    """Print each step of a roll-out until its end, or until nobody reads any more."""
    for view in rollouts.follow(id, _warn_of_lost_connection):
        line = json.dumps(view) + "\n" if format is TextOrJson.JSON else rollout_line(view)
        if not print_part(line):
            break
    return Outcome("", FINDINGS if has_failed(view) else OK)


def _warn_of_lost_connection(error: Exception) -> None:
    sys.stderr.write(f"the service is away, trying again: {error}\n")

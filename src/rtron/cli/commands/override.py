"""What a person asks of a guard on this machine: `rtron override`, `clear` and `lease`."""

from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from typing import Annotated, Any

import typer

from rtron.cli.support.control_request import send_request
from rtron.cli.support.options import PlanOption, TextOrJson
from rtron.cli.support.outcome import Outcome, as_json
from rtron.errors import InputError

ControlSocketOption = Annotated[
    Path | None,
    typer.Option(metavar="SOCKET", help="The control socket of the guard, as in its log."),
]


def override(
    id: Annotated[str, typer.Argument(metavar="ID", help="The coordination node: its plan `id`.")],
    *,
    plan: PlanOption,
    duration: Annotated[
        str, typer.Option("--for", metavar="TIME", help="Duration: 30 s, 2 min; 0 cancels it.")
    ],
    reason: Annotated[str, typer.Option(metavar="TEXT", help="The reason, for the log.")] = "",
    control_socket: ControlSocketOption = None,
) -> Outcome:
    """Suspend an RSRCN or MSRCN for a limited time.

    For a person beside the robot, who docks it or drives it out of a forbidden
    area. The guard logs the user, the reason and the duration, and shows them
    in its diagnostics. Invalid values (NaN) and publishers that are not in the
    plan stay blocked. A restart of the guard ends the override.

    $ rtron override rsrcn --for 30s --reason docking --plan rtron.yaml
    $ rtron override rsrcn --for 0 --plan rtron.yaml

    Exit code: 0 granted, 2 not.
    """
    from rtron.planning.plan_file.quantities import parse_duration, write_duration

    try:
        nanoseconds = parse_duration(duration)
    except ValueError as error:
        raise InputError(f"--for: {error}") from None
    request = {"override": id, "duration": nanoseconds, "reason": reason}
    _send_to_guard(plan, control_socket, request)
    left = f"overridden for {write_duration(nanoseconds)}" if nanoseconds else "active again"
    return Outcome(f"{id} is {left}\n")


def clear(
    topic: Annotated[
        str, typer.Argument(metavar="TOPIC", help="The guarded topic; without it, all of them.")
    ] = "",
    *,
    plan: PlanOption,
    reason: Annotated[str, typer.Option(metavar="TEXT", help="The reason, for the log.")],
    control_socket: ControlSocketOption = None,
) -> Outcome:
    """Let the robot drive again after an intrusion.

    A guard with `on_foreign: stop` stops what an intruder can move, and keeps
    it stopped when the intruder is gone, until a person clears it. Find out
    first who it was: the guard's log and diagnostics name it. The guard logs
    your user name and the reason. It refuses while the intruder is there.

    $ rtron clear /cmd_vel --reason "a forgotten rostopic pub" --plan rtron.yaml

    Exit code: 0 cleared, 2 not.
    """
    answer = _send_to_guard(plan, control_socket, {"clear": topic, "reason": reason})
    cleared = answer.get("cleared")
    names = ", ".join(map(str, cleared)) if isinstance(cleared, list) else ""
    return Outcome(f"{names}: cleared, the robot may drive again\n")


def stop(
    *,
    plan: PlanOption,
    reason: Annotated[str, typer.Option(metavar="TEXT", help="The reason, for the log.")] = "",
    control_socket: ControlSocketOption = None,
) -> Outcome:
    """Stop the robot until a person releases it.

    Nothing that moves the robot passes, also after a restart of the guard, of
    its supervisor or of the machine, until `rtron release robot`.

    $ rtron stop --reason "a person on the track" --plan rtron.yaml

    Exit code: 0 stopped, 2 not.
    """
    answer = _send_to_guard(plan, control_socket, {"stop": reason})
    return Outcome(f"{answer.get('answer')}\n")


def release(
    source: Annotated[
        str, typer.Argument(metavar="SOURCE", help="What has stopped the robot; without it, list.")
    ] = "",
    *,
    plan: PlanOption,
    reason: Annotated[str, typer.Option(metavar="TEXT", help="The reason, for the log.")] = "",
    control_socket: ControlSocketOption = None,
) -> Outcome:
    """Release what has stopped the robot; without a source, list it.

    Each source that has stopped the robot must be released: `robot` is a person
    here (`rtron stop`), the others are the buttons of the plan. The guard
    refuses while the cause is there, while a commander does not stand still,
    and without a reason. If the plan says so, a second person must release it,
    too.

    $ rtron release --plan rtron.yaml
    $ rtron release robot --reason "the track is free" --plan rtron.yaml

    Exit code: 0 released or listed, 2 not.
    """
    answer = _send_to_guard(plan, control_socket, {"release": source, "reason": reason})
    stops = answer.get("stops")
    lines = [f"{name}: {text}" for name, text in _stop_texts(stops if source == "" else None)]
    shown = answer.get("answer") or "\n".join(lines) or "nothing has stopped the robot"
    return Outcome(f"{shown}\n")


def _stop_texts(stops: object) -> Iterator[tuple[str, str]]:
    for name, each in stops.items() if isinstance(stops, dict) else ():
        since = datetime.fromtimestamp(each["since"] / 1e9).astimezone()
        yield name, f"by {each['by']} since {since:%Y-%m-%d %H:%M:%S}: {each['reason']}"


lease = typer.Typer(
    name="lease", no_args_is_help=True, help="Show who is in command of a robot, and change it."
)

Name = Annotated[str, typer.Argument(metavar="LEASE", help="The name of the lease in the plan.")]
Reason = Annotated[str, typer.Option(metavar="TEXT", help="The reason, for the log.")]


@lease.callback()
def lease_group() -> None:
    """Show who is in command of a robot, and change it, beside the robot.

    Nodes ask for leases on a topic. A person who may control the guard on this
    machine stands above their ranks.
    """


@lease.command("list")
def list_leases(
    *,
    plan: PlanOption,
    format: Annotated[TextOrJson, typer.Option(help="Text, or JSON.")] = TextOrJson.TEXT,
    control_socket: ControlSocketOption = None,
) -> Outcome:
    """Show who holds each lease, since when and why.

    $ rtron lease list --plan rtron.yaml

    Exit code: 0 shown, 2 no guard answers.
    """
    leases = _request(plan, control_socket, "list").get("leases")
    listed = leases if isinstance(leases, list) else []
    if format is TextOrJson.JSON:
        return Outcome(as_json({"leases": listed}))
    return Outcome("".join(map(_lease_line, listed)) or "the plan has no leases\n")


@lease.command()
def give(
    name: Name,
    to: Annotated[str, typer.Argument(metavar="NODE", help="The commander: its node name.")],
    *,
    plan: PlanOption,
    reason: Reason,
    control_socket: ControlSocketOption = None,
) -> Outcome:
    """Give a lease to a commander, whoever holds it.

    The robot stops. The new holder must send a neutral command before it moves
    anything, and renew the lease in time. The guard logs your user name.

    $ rtron lease give base /teleop --reason "docking by hand" --plan rtron.yaml

    Exit code: 0 given, 2 not.
    """
    answer = _request(plan, control_socket, "give", lease=name, to=to, reason=reason)
    return Outcome(f"{answer.get('answer')}\n")


@lease.command()
def end(
    name: Name, *, plan: PlanOption, reason: Reason, control_socket: ControlSocketOption = None
) -> Outcome:
    """Take a lease from its holder; the robot stops, until somebody has it.

    $ rtron lease end base --reason "maintenance" --plan rtron.yaml

    Exit code: 0 ended, 2 not.
    """
    answer = _request(plan, control_socket, "end", lease=name, reason=reason)
    return Outcome(f"{answer.get('answer')}\n")


def _request(plan: Path, control_socket: Path | None, what: str, **values: str) -> dict[str, Any]:
    request: dict[str, object] = {"lease": "", "do": what, "to": "", "reason": "", **values}
    return _send_to_guard(plan, control_socket, request)


def _lease_line(lease: dict[str, Any]) -> str:
    if not lease.get("holder"):
        return f"{lease.get('lease')}: {lease.get('reason')}\n"
    since = datetime.fromtimestamp(float(lease["since"])).astimezone()
    text = f"{lease['holder']} ({lease['rank']}) since {since:%Y-%m-%d %H:%M:%S}"
    return f"{lease.get('lease')}: {text}, {lease.get('reason')}\n"


def _send_to_guard(plan: Path, path: Path | None, request: dict[str, object]) -> dict[str, Any]:
    """Return the answer of the guard of a plan, at `path` if it listens elsewhere."""
    from rtron.guard.core.control_socket import control_path
    from rtron.planning.plan_file.loader import read_plan

    return send_request(path or control_path(read_plan(plan).app), request)

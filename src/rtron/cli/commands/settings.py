"""`rtron settings`."""

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rtron.cli.support.options import TextOrJson
from rtron.cli.support.outcome import FINDINGS, OK, Outcome, as_json
from rtron.cli.support.service_options import RobotOption, calls_service
from rtron.cli.support.settings_arguments import complete_setting, parse_patch

if TYPE_CHECKING:
    from rtron.reports.text_layout import Report
    from rtron.workflows.apply_settings import AppliedSettings, RobotSettings
    from rtron.workflows.service_client import SecurityServiceClient

settings = typer.Typer(
    name="settings", no_args_is_help=True, help="Show and change what a guard enforces."
)


Node = Annotated[str, typer.Argument(metavar="NODE", help="The coordination node: its `id`.")]
Reason = Annotated[str, typer.Option(metavar="TEXT", help="The reason, for the audit log.")]
Wait = Annotated[bool, typer.Option("--wait", help="Wait until the guard has applied it.")]
Timeout = Annotated[float, typer.Option(min=0.1, metavar="S", help="The limit of --wait, seconds.")]


@settings.callback()
def settings_group() -> None:
    """Show and change what a guard enforces, through the security service."""


@settings.command()
@calls_service
def get(
    client: "SecurityServiceClient",
    node: Annotated[
        str | None, typer.Argument(metavar="NODE", help="One coordination node, in full.")
    ] = None,
    *,
    robot: RobotOption = "",
    format: Annotated[TextOrJson, typer.Option(help="A table, or JSON.")] = TextOrJson.TEXT,
) -> Outcome:
    """Show the active settings, and where they differ from the plan.

    $ rtron settings get --token-file me.token
    $ rtron settings get speed --robot car1 --token-file me.token
    $ rtron settings get --format json | jq '.nodes[].effective.policy'

    RTRON_SERVICE, RTRON_TOKEN_FILE and RTRON_ROBOT save typing.
    """
    from rtron.cli.support.settings_report import node_report, nodes_report

    active = _robot_settings(client, robot)
    view = active.view()
    if node is not None:
        one = active.node(node)
        return _render(format, {"settings": view, "node": one}, node_report(view, one))
    nodes = active.nodes()
    report = nodes_report(active.robot, view, nodes)
    return _render(format, {"settings": view, "nodes": nodes}, report)


@settings.command()
@calls_service
def set(
    client: "SecurityServiceClient",
    node: Node,
    assignments: Annotated[
        list[str],
        typer.Argument(
            metavar="KEY=VALUE...", help="The settings to change.", autocompletion=complete_setting
        ),
    ],
    *,
    robot: RobotOption = "",
    reason: Reason,
    wait: Wait = False,
    timeout: Timeout = 10.0,
) -> Outcome:
    """Change a coordination node while the guard runs.

    $ rtron settings set drive flow1.timeout=200ms --reason "slow radio"
    $ rtron settings set drive flow1.priority=3 flow2.block=true --reason test
    $ rtron settings set speed max_vel_limit=0.3 --reason visitors --wait
    $ rtron settings set mission keep_out.selected=false --reason docking
    $ rtron settings set drive policy=plan flow1.priority=plan --reason over

    A rule of your own: night.when='dark && !docked' night.block=/goal

    Keys: policy, release_after, max_age, max_hold, threshold, max_vel_limit;
    of a flow: priority, block, timeout; of a rule: selected, when, block.
    The value `plan` restores the plan's value. A command is one change.
    Developers set GRCNs, end users select in RSRCN and MSRCN: docs/settings.md.

    Exit code: 0 stored and sent (with --wait: active), 1 the guard rejected it
    or did not answer, 2 nothing changed.
    """
    active = _robot_settings(client, robot, timeout if wait else None)
    planned = active.planned_node(node)
    patch = parse_patch(assignments, planned.flow_names, has_rules=planned.has_rules)
    return _outcome(active.change(planned, patch, reason))


@settings.command()
@calls_service
def stop(
    client: "SecurityServiceClient",
    *,
    robot: RobotOption = "",
    reason: Reason = "",
    wait: Wait = False,
    timeout: Timeout = 10.0,
) -> Outcome:
    """Emergency stop: block every command that moves the robot, until `release`.

    $ rtron settings stop --robot car1 --token-file me.token

    Every role may do this. Repeat it to send the stop again.

    Exit code: as for `rtron settings set`.
    """
    return _outcome(_robot_settings(client, robot, timeout if wait else None).stop(reason))


@settings.command()
@calls_service
def release(
    client: "SecurityServiceClient",
    *,
    robot: RobotOption = "",
    reason: Annotated[str, typer.Option(metavar="TEXT", help="Why it is safe, for the audit log.")],
    wait: Wait = False,
    timeout: Timeout = 10.0,
) -> Outcome:
    """End the emergency stop: commands move the robot again.

    $ rtron settings release --robot car1 --reason "area is clear"

    It prints who stopped the robot. A new stop of the same moment stays active.

    Exit code: as for `rtron settings set`.
    """
    from rtron.cli.support.settings_report import stop_line

    active = _robot_settings(client, robot, timeout if wait else None)
    before = active.view()
    outcome = _outcome(active.release(before["revision"], reason))
    return replace(outcome, shown=f"{stop_line(before)}{outcome.shown}")


def _robot_settings(
    client: "SecurityServiceClient", robot: str, timeout: float | None = None
) -> "RobotSettings":
    from rtron.workflows.apply_settings import RobotSettings

    return RobotSettings(client, client.resolve_robot(robot), timeout)


def _outcome(applied: "AppliedSettings") -> Outcome:
    from rtron.cli.support.settings_report import outcome_line

    return Outcome(outcome_line(applied.view), FINDINGS if applied.has_failed else OK)


def _render(format: TextOrJson, document: Mapping[str, Any], report: "Report") -> Outcome:
    return Outcome(as_json(document) if format is TextOrJson.JSON else report)

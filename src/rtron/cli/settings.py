"""`rtron settings`."""

import time
from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any

import typer

from rtron.cli.client import (
    DEFAULT_SERVICE,
    CaOption,
    Client,
    RobotOption,
    ServiceOption,
    TokenOption,
    client,
)
from rtron.cli.options import TextOrJson
from rtron.cli.outcome import FOUND, OK, Outcome, as_json
from rtron.cli.settings_text import node_report, nodes_report, stopped_by, told
from rtron.cli.settings_words import KEYS, patch_of
from rtron.reports.text_layout import Report

settings = typer.Typer(
    name="settings", no_args_is_help=True, help="See and change what a guard enforces."
)
_LOOK_S = 0.05
_PENDING = "pending"


def _complete_word(incomplete: str) -> list[str]:
    return [f"{key}=" for key in KEYS if key.startswith(incomplete)]


Node = Annotated[str, typer.Argument(metavar="NODE", help="The coordination node: its `id`.")]
Reason = Annotated[str, typer.Option(metavar="TEXT", help="Why; it goes into the audit log.")]
Wait = Annotated[bool, typer.Option("--wait", help="Until the guard has put it in force.")]
Timeout = Annotated[float, typer.Option(min=0.1, metavar="S", help="Seconds to wait for that.")]


@settings.callback()
def of_robots() -> None:
    """See and change what a guard enforces, through the security service."""


@settings.command()
def get(
    node: Annotated[
        str | None, typer.Argument(metavar="NODE", help="One coordination node, in full.")
    ] = None,
    *,
    service: ServiceOption = DEFAULT_SERVICE,
    token_file: TokenOption = None,
    robot: RobotOption = "",
    ca: CaOption = None,
    format: Annotated[TextOrJson, typer.Option(help="A table, or JSON.")] = TextOrJson.TEXT,
) -> Outcome:
    """Show what is in force, and what of it differs from the plan.

    $ rtron settings get --token-file me.token
    $ rtron settings get speed --robot car1 --token-file me.token
    $ rtron settings get --format json | jq '.nodes[].effective.policy'

    RTRON_SERVICE, RTRON_TOKEN_FILE and RTRON_ROBOT save typing.
    """
    called = client(service, token_file, ca)
    name = called.robot(robot)
    view = called.get("robots", name, "settings")
    if node is not None:
        one = called.get("robots", name, "nodes", node)
        return _shown(format, {"settings": view, "node": one}, node_report(view, one))
    nodes = called.get("robots", name, "nodes")
    return _shown(format, {"settings": view, "nodes": nodes}, nodes_report(name, view, nodes))


@settings.command()
def set(  # noqa: PLR0913 - one for each option
    node: Node,
    words: Annotated[
        list[str],
        typer.Argument(metavar="KEY=VALUE...", help="What to set.", autocompletion=_complete_word),
    ],
    *,
    service: ServiceOption = DEFAULT_SERVICE,
    token_file: TokenOption = None,
    robot: RobotOption = "",
    ca: CaOption = None,
    reason: Reason = "",
    wait: Wait = False,
    timeout: Timeout = 10.0,
) -> Outcome:
    """Change a coordination node while the guard runs.

    $ rtron settings set drive policy=Priority_Queue flow1.timeout=200ms
    $ rtron settings set drive flow1.priority=3 flow2.block=true
    $ rtron settings set speed policy=Constrain max_vel_limit=0.3 --wait
    $ rtron settings set mission keep_out.selected=false
    $ rtron settings set mission own.when='night && !alone' own.block=/goal
    $ rtron settings set drive flow1.priority=plan

    policy, release_after, max_age, max_hold, threshold, max_vel_limit;
    of a flow: priority, block, timeout; of a rule: selected, when, block.
    `plan` as a value takes it back to what the plan says. All of one command
    is one change. Developers set GRCNs, end users select in RSRCN and MSRCN:
    docs/settings.md.

    Exit code: 0 stored and sent (with --wait: in force), 1 the guard refused
    it or did not answer, 2 nothing was changed.
    """
    called = client(service, token_file, ca)
    name = called.robot(robot)
    view = called.get("robots", name, "settings")
    planned = called.get("robots", name, "nodes", node)["plan"]
    patch = patch_of(words, _flows(planned), has_rules="rules" in planned)
    body = {"revision": view["revision"], "nodes": {node: patch}, "reason": reason}
    made = called.patch("robots", name, "settings", body=body)
    return _outcome(called, name, made, timeout if wait else None)


@settings.command()
def stop(
    *,
    service: ServiceOption = DEFAULT_SERVICE,
    token_file: TokenOption = None,
    robot: RobotOption = "",
    ca: CaOption = None,
    reason: Reason = "",
    wait: Wait = False,
    timeout: Timeout = 10.0,
) -> Outcome:
    """Emergency stop: nothing that moves the robot passes until `release`.

    $ rtron settings stop --robot car1 --token-file me.token

    Every role may. The same once more is sent again until it is in force.

    Exit code: as of `rtron settings set`.
    """
    called = client(service, token_file, ca)
    name = called.robot(robot)
    view = called.post("robots", name, "stop", body={"reason": reason})
    return _outcome(called, name, view, timeout if wait else None)


@settings.command()
def release(
    *,
    service: ServiceOption = DEFAULT_SERVICE,
    token_file: TokenOption = None,
    robot: RobotOption = "",
    ca: CaOption = None,
    reason: Annotated[
        str, typer.Option(metavar="TEXT", help="Why it is safe; it goes into the audit log.")
    ],
    wait: Wait = False,
    timeout: Timeout = 10.0,
) -> Outcome:
    """End the emergency stop: what is commanded moves the robot again.

    $ rtron settings release --robot car1 --reason "area is clear"

    Says whose stop that was. One that comes at the same moment stays.

    Exit code: as of `rtron settings set`.
    """
    called = client(service, token_file, ca)
    name = called.robot(robot)
    seen = called.get("robots", name, "settings")
    body = {"reason": reason, "revision": seen["revision"]}
    view = called.delete("robots", name, "stop", body=body)
    outcome = _outcome(called, name, view, timeout if wait else None)
    return replace(outcome, shown=f"{stopped_by(seen)}{outcome.shown}")


def _outcome(
    called: Client, robot: str, view: Mapping[str, Any], patience: float | None
) -> Outcome:
    """Say what became of settings; with `patience` (s) once the guard has answered."""
    if patience is not None:
        view = _answered(called, robot, view, patience)
    waited_in_vain = patience is not None and view["outcome"] == _PENDING
    failed = view["outcome"] == "refused" or waited_in_vain
    return Outcome(told(view), FOUND if failed else OK)


def _answered(
    called: Client, robot: str, view: Mapping[str, Any], timeout: float
) -> Mapping[str, Any]:
    """Return the settings once the guard has answered them, or as they are after `timeout` s."""
    until = time.monotonic() + timeout
    before = view["revision"] + 1
    while view["outcome"] == _PENDING and time.monotonic() < until:
        time.sleep(_LOOK_S)
        (view,) = called.get("robots", robot, "settings", "history", before=before, limit=1)
    return view


def _flows(node: Mapping[str, Any]) -> list[str]:
    """Return the names of the flows that may be set at a coordination node, as the plan has it."""
    guarded = [*node.get("vflows", ()), *node.get("aflows", ())]
    flows = [*node.get("flows", ()), *(flow for topic in guarded for flow in topic["flows"])]
    return [flow["name"] for flow in flows]


def _shown(format: TextOrJson, document: Mapping[str, Any], report: Report) -> Outcome:
    return Outcome(as_json(document) if format is TextOrJson.JSON else report)

"""`rtron bridge`, and `rtron mcp`, which is a client of it."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rtron.cli.commands.guard import LogLevel
from rtron.cli.support.control_request import send_request
from rtron.cli.support.options import DEFAULT_MASTER, Domain, Master
from rtron.cli.support.outcome import Outcome
from rtron.errors import InputError
from rtron.workflows.live_app import app_address

if TYPE_CHECKING:
    from rtron.bridge.rights.document import BridgeRights
    from rtron.vocabulary import Plan

_LAST_PORT = 65535
_DEFAULT_PORT = 9090
"""rosbridge's own."""

bridge = typer.Typer(
    name="bridge", help="Let web pages and programs take part, each with rights of its own."
)

BridgePlan = Annotated[Path, typer.Option("--plan", metavar="rtron.yaml", help="The plan.")]
RightsOption = Annotated[
    Path, typer.Option("--rights", metavar="bridge.yaml", help="Who may do what.")
]
_HELP = """Let web pages and programs take part, each with rights of its own.

Speaks the rosbridge v2 protocol over WebSocket: roslibjs and roslibpy connect
as to rosbridge, with a token. Each client is a node, /bridge/NAME, which may
do what bridge.yaml lists for it and nothing else. What it publishes on a
guarded topic is a flow of the plan.

$ rtron bridge --plan rtron.yaml --rights bridge.yaml
$ rtron bridge token tablet
$ rtron bridge check --plan rtron.yaml --rights bridge.yaml
$ rtron bridge requests

Exit code: 0 stopped, 2 bad plan or rights, or the port is taken."""
_DEFAULT_ADDRESS = "ws://127.0.0.1:9090/"
_PLAN, _RIGHTS = Path("rtron.yaml"), Path("bridge.yaml")


@bridge.callback(invoke_without_command=True, help=_HELP)
def run(  # noqa: PLR0913 - one for each option
    ctx: typer.Context,
    *,
    plan: BridgePlan = _PLAN,
    rights: RightsOption = _RIGHTS,
    host: Annotated[
        str,
        typer.Option(
            metavar="ADDRESS", help="Where to listen: this machine alone, or 0.0.0.0 for all."
        ),
    ] = "127.0.0.1",
    port: Annotated[
        int, typer.Option(min=0, max=_LAST_PORT, metavar="PORT", help="The port; 0 is a free one.")
    ] = _DEFAULT_PORT,
    master: Master = DEFAULT_MASTER,
    domain: Domain = None,
    log_level: Annotated[LogLevel, typer.Option(help="How much to log.")] = LogLevel.INFO,
) -> Outcome | None:
    """Run the bridge, where no other command is given."""
    if ctx.invoked_subcommand:
        return None
    from rtron.bridge.server.runner import run_bridge
    from rtron.guard.log_format import start_logging

    known, granted = _read(plan, rights)
    start_logging(log_level.value.upper(), "bridge")
    address = app_address(known.ros, master, domain)
    run_bridge(known, granted, address, host, port)
    return Outcome("")


@bridge.command()
def check(*, plan: BridgePlan = _PLAN, rights: RightsOption = _RIGHTS) -> Outcome:
    """Check the rights of a bridge's clients: the file, and whether it fits the plan.

    It also names the types that are neither in the plan nor installed here:
    where the bridge runs they must be.

    $ rtron bridge check
    $ rtron bridge check --plan rtron.yaml --rights bridge.yaml

    Exit code: 0 it is right, 2 it is not.
    """
    from rtron.bridge.common.message_types import unknown_types
    from rtron.bridge.known_types import known_types

    known, granted = _read(plan, rights)
    unknown = list(unknown_types(granted, known.ros, known_types(known)))
    count = len(granted.clients)
    clients = f"{rights}: {count} client{'s' * (count != 1)}"
    if not unknown:
        return Outcome(f"{clients}, no problem\n")
    lines = "".join(f"  {problem}\n" for problem in unknown)
    return Outcome(
        f"{clients}; refused where the bridge runs, unless it knows more types:\n{lines}"
    )


@bridge.command()
def token(
    name: Annotated[str, typer.Argument(metavar="NAME", help="The name of the client.")],
) -> Outcome:
    """Make a token for a client, and show it once.

    Only its hash is for bridge.yaml. Run it again for a new token; an old one
    ends when its hash is no longer in the file and the bridge has restarted.

    $ rtron bridge token tablet

    Exit code: 0 made, 2 not a name.
    """
    from rtron.bridge.rights.tokens import new_token, rights_entry

    secret = new_token()
    try:
        entry = rights_entry(name, secret)
    except ValueError:
        help = "small letters, digits and _, beginning with a letter, as in tablet_2"
        raise InputError(f"{name[:80]!r} is no name of a client", help=help) from None
    return Outcome(f"The token of {name}, for the client alone:\n\n  {secret}\n\n{entry}")


@bridge.command()
def requests(*, plan: BridgePlan = _PLAN) -> Outcome:
    """List what clients ask for and a person must approve.

    $ rtron bridge requests --plan rtron.yaml

    Exit code: 0 listed, 2 no bridge answers.
    """
    found = _ask_bridge(plan, "list")
    listed = found.get("requests", [])
    lines = [f"{x['number']}: {x['client']}: {x['what']}: {x['content']}\n" for x in listed]
    if more := found.get("count", 0) - len(lines):
        lines.append(f"and {more} more, listed when these are answered\n")
    return Outcome("".join(lines) or "nobody asks for anything\n")


Number = Annotated[int, typer.Argument(metavar="NUMBER", help="The number of the request.")]
Reason = Annotated[str, typer.Option(metavar="TEXT", help="The reason, for the log.")]


@bridge.command()
def approve(number: Number, *, plan: BridgePlan = _PLAN, reason: Reason = "") -> Outcome:
    """Let a client send once, within a minute, what it has asked for.

    $ rtron bridge approve 3 --reason "the corridor is free"

    Exit code: 0 approved, 2 not.
    """
    return Outcome(f"{_ask_bridge(plan, 'approve', number, reason).get('answer')}\n")


@bridge.command()
def refuse(number: Number, *, plan: BridgePlan = _PLAN, reason: Reason = "") -> Outcome:
    """Refuse what a client has asked for.

    $ rtron bridge refuse 3 --reason "not today"

    Exit code: 0 refused, 2 not.
    """
    return Outcome(f"{_ask_bridge(plan, 'refuse', number, reason).get('answer')}\n")


def _ask_bridge(plan: Path, what: str, number: int = 0, reason: str = "") -> dict[str, Any]:
    from rtron.bridge.server.runner import bridge_control_path
    from rtron.planning.plan_file.loader import read_plan

    request: dict[str, object] = {"approval": what, "number": number, "reason": reason}
    return send_request(bridge_control_path(read_plan(plan).app), request, "bridge")


def mcp(
    plan: Annotated[Path, typer.Argument(metavar="rtron.yaml", help="The plan.")],
    *,
    name: Annotated[str, typer.Option(metavar="NAME", help="The agent's name in bridge.yaml.")],
    address: Annotated[
        str, typer.Option("--bridge", metavar="URL", help="The address of the bridge.")
    ] = _DEFAULT_ADDRESS,
    token_file: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="The agent's token; otherwise RTRON_BRIDGE_TOKEN."),
    ] = None,
    graph: Annotated[
        Path | None, typer.Option(metavar="GRAPH.json", help="The app's interaction graph.")
    ] = None,
) -> Outcome:
    """Let a language model ask about a robot, and command it within its rights.

    Serves the Model Context Protocol on standard input and output, for the
    program that runs the model. It is a client of `rtron bridge`, and has no
    rights but those of NAME there: it tells the model beforehand what the guard
    would refuse, and why. Needs `pip install "rtron[mcp]"`.

    $ rtron mcp rtron.yaml --name assistant --token-file assistant.token

    Exit code: 0 ended, 2 bad plan, no token, or an agent without a lease.
    """
    from rtron.bridge.agents.server import read_token, run_agent_server
    from rtron.planning.plan_file.loader import read_plan
    from rtron.sources.graph_json import read_graph

    known = read_graph(graph) if graph else None
    run_agent_server(read_plan(plan), name, address, read_token(token_file), known)
    return Outcome("")


def _read(plan: Path, rights: Path) -> "tuple[Plan, BridgeRights]":
    from rtron.bridge.common.plan_topics import check_rights
    from rtron.bridge.rights.rights_file import read_rights
    from rtron.planning.plan_file.loader import read_plan

    known, granted = read_plan(plan), read_rights(rights)
    check_rights(granted, known, str(rights))
    return known, granted

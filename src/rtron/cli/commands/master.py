"""`rtron master` and `rtron cell`: who may connect to whom."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from rtron.cli.commands.guard import LogLevel
from rtron.cli.support.options import DEFAULT_MASTER, Domain, Master, PlanOption
from rtron.cli.support.outcome import Outcome
from rtron.errors import InputError, WireError
from rtron.workflows.live_app import app_address

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtron.guard.cell.isolation import Gap

_LAST_PORT = 65535


def master(
    *,
    plan: PlanOption,
    port: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=_LAST_PORT,
            metavar="PORT",
            help="The port of the master.  [default: that of ROS_MASTER_URI]",
            show_default=False,
        ),
    ] = None,
    host: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="The host name of the master.  [default: ROS_HOSTNAME, ROS_IP or this machine]",
            show_default=False,
        ),
    ] = "",
    private_port: Annotated[
        int,
        typer.Option(
            min=0,
            max=_LAST_PORT,
            metavar="PORT",
            help="The port of rosmaster behind the proxy, on loopback; 0 is a free port. A "
            "firewall rule needs a fixed one.",
        ),
    ] = 0,
    log_level: Annotated[LogLevel, typer.Option(help="How much to log.")] = LogLevel.INFO,
) -> Outcome:
    """Run the ROS master behind a proxy that rejects what the plan forbids.

    Run it instead of roscore, before the guarded launch file. No node can
    publish a topic of the guard, take a name of the guard, or take the name of
    a node in the plan while that node runs. Everything else works as usual.

    $ rtron master --plan rtron.yaml
    $ roslaunch guarded.launch

    Exit code: 0 stopped, 2 bad plan, port taken, or rosmaster has ended.
    """
    from rtron.guard.log_format import start_logging
    from rtron.guard.master_proxy.process import run_master
    from rtron.planning.plan_file.loader import read_plan
    from rtron.wire.ros1.network import advertised_host

    start_logging(log_level.value.upper())
    known = read_plan(plan)
    at = port or _master_port()
    return Outcome("", run_master(known, host or advertised_host(), at, private_port=private_port))


def _master_port() -> int:
    from rtron.wire.ros1.network import master_uri
    from rtron.wire.ros1.xmlrpc import split_uri

    try:
        return split_uri(master_uri())[1]
    except WireError as error:
        raise InputError(f"ROS_MASTER_URI: {error}", help="give --port") from None


CellUser = Annotated[
    str,
    typer.Option(
        "--user",
        metavar="NAME",
        help="The user of the node in the cell; nothing outside may run as this user.  "
        "[default: a number that nobody has]",
        show_default=False,
    ),
]
GuardUser = Annotated[
    str,
    typer.Option(
        metavar="NAME",
        help="The user of the guard, and of nothing else.  [default: who starts the cell]",
        show_default=False,
    ),
]
AllowSharedUser = Annotated[
    bool,
    typer.Option(
        "--allow-shared-user",
        help="Let the node run as the user who starts the cell. OPEN: each process of this user "
        "can enter the cell.",
    ),
]
AllowSharedMemory = Annotated[
    bool,
    typer.Option(
        "--allow-shared-memory",
        help="Let the cell share /dev/shm. OPEN: each process can speak to the node by the shared "
        "memory of Fast DDS.",
    ),
]


def cell(  # noqa: PLR0913 - one for each option
    command: Annotated[
        list[str], typer.Argument(metavar="-- COMMAND…", help="The command that starts the node.")
    ],
    *,
    plan: PlanOption,
    manifest: Annotated[
        Path,
        typer.Option(metavar="CELL.json", help="What passes, as `rtron instrument` has written."),
    ],
    master: Master = DEFAULT_MASTER,
    domain: Domain = None,
    user: CellUser = "",
    guard_user: GuardUser = "",
    allow_shared_user: AllowSharedUser = False,
    allow_shared_memory: AllowSharedMemory = False,
    log_level: Annotated[LogLevel, typer.Option(help="How much to log.")] = LogLevel.INFO,
) -> Outcome:
    """Run a node in a cell: a network of its own, into which only the guard leads.

    `rtron instrument --cell /base` writes a launch file that starts the node so.
    The cell has a network, a user, a /dev/shm and processes of its own, and
    refuses to start where it does not get them. When nobody guards it any more,
    it stops the robot.

    $ rtron cell --plan rtron.yaml --manifest base.json -- rosrun kobuki base
    $ rtron cell --plan rtron.yaml --manifest base.json --user driver -- ./base

    Start it as root. An ordinary user gets a cell that all processes of this
    user can enter, and only with --allow-shared-user.

    On ROS 2 a cell is for Fast DDS without SROS2, and carries no actions.

    Exit code: that of the node; 2 bad plan or manifest, or no cell.
    """
    from rtron.guard.cell.runner import CellRequest, read_manifest, run_cell
    from rtron.guard.log_format import start_logging
    from rtron.planning.plan_file.loader import read_plan

    known, carried = read_plan(plan), read_manifest(manifest)
    start_logging(log_level.value.upper(), "cell gateway")
    allowed = frozenset(_allowed(user=allow_shared_user, memory=allow_shared_memory))
    request = CellRequest(
        plan=known,
        manifest=carried,
        address=app_address(known.ros, master, domain),
        command=command,
        files=(plan, manifest),
        user=user,
        guard_user=guard_user,
        allowed=allowed,
        log_level=log_level.value.upper(),
    )
    return Outcome("", run_cell(request))


def _allowed(*, user: bool, memory: bool) -> "Iterator[Gap]":
    from rtron.guard.cell.isolation import Gap

    if user:
        yield Gap.SHARED_USER
    if memory:
        yield Gap.SHARED_MEMORY

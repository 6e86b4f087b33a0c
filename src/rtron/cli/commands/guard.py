"""`rtron guard`."""

import socket
import sys
from collections.abc import Callable
from enum import Enum
from pathlib import Path
from typing import Annotated

import typer

from rtron.cli.support.options import DEFAULT_MASTER, Domain, Master, PlanOption
from rtron.cli.support.service_options import CaOption, ServiceOption, TokenOption
from rtron.errors import InputError
from rtron.guard.link.options import LinkOptions, state_folder
from rtron.planning.plan_file.loader import read_plan
from rtron.vocabulary import MeasuredRun
from rtron.wire.ros2.domain_id import domain_id
from rtron.workflows.launch_arguments import parse_assignments

Robot = Annotated[
    str,
    typer.Option(metavar="NAME", envvar="RTRON_ROBOT", help="What the service calls this robot."),
]
State = Annotated[
    Path | None,
    typer.Option(metavar="FOLDER", help="Where settings and waiting events are kept."),
]


def build_link_options(
    app: str,
    service: str,
    token_file: Path | None,
    robot: str,
    state: Path | None,
    ca: Path | None,
) -> LinkOptions:
    """Return the link's options, all of them checked; InputError if one cannot be used."""
    if token_file is None:
        help = "make one with `rtron token create`, and give --token-file FILE"
        raise InputError("--service without --token-file", help=help)
    options = LinkOptions(
        service=service,
        token_file=token_file.absolute(),
        robot=robot or socket.gethostname(),
        state=(state or state_folder(app)).absolute(),
        ca=ca.absolute() if ca else None,
    )
    options.token()
    options.prepare()
    if options.url and options.is_unencrypted:
        sys.stderr.write(f"warning: {service} is not encrypted: others can read the token\n")
    return options


class LogLevel(str, Enum):
    """How much the guard says on standard error."""

    DEBUG = "debug"
    INFO = "info"
    WARNING = "warning"
    ERROR = "error"


def guard(  # noqa: PLR0913 - one for each option
    launch_arguments: Annotated[
        list[str] | None,
        typer.Argument(metavar="NAME:=VALUE", help="What roslaunch appends; accepted, not used."),
    ] = None,
    *,
    plan: PlanOption,
    master: Master = DEFAULT_MASTER,
    domain: Domain = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Let everything pass; report what would be done.")
    ] = False,
    figures: Annotated[
        Path | None,
        typer.Option(metavar="RUN.json", help="Keep what a dry run measures, for `rtron plan`."),
    ] = None,
    control: Annotated[
        Path | None,
        typer.Option(metavar="SOCKET", help="Where to listen for `rtron override`."),
    ] = None,
    service: ServiceOption = "",
    token_file: TokenOption = None,
    robot: Robot = "",
    state: State = None,
    ca: CaOption = None,
    log_level: Annotated[LogLevel, typer.Option(help="How much to log.")] = LogLevel.INFO,
) -> None:
    """Stand between the app's nodes, as the plan says, until stopped.

    The guarded launch starts it. Start it by hand to try a plan out, or to
    watch with a plan whose coordination nodes all observe.

    $ rtron guard --plan rtron.yaml
    $ rtron guard --plan rtron.yaml --dry-run
    $ rtron guard --plan rtron.yaml --dry-run --figures run.json
    $ rtron guard --plan rtron.yaml --master http://robot:11311 --log-level debug
    $ rtron guard --plan rtron.yaml --domain 7       a plan that says `ros: 2`
    $ rtron guard --plan rtron.yaml --service https://host:8600 --token-file F

    A master that does not answer is waited for. With ROS 2 the range of discovery
    and the RMW are those of the environment. A dry run stands in the flows
    but forbids nothing: diagnostics and log tell what would have been stopped.
    `rtron plan --from-run run.json` makes settings of the figures that it keeps.

    With --service the guard tells the security service what happens, and takes
    settings from people in its console. A third process does that, so that a
    service which is slow or away delays nothing; meanwhile the last settings
    count and events wait on disk, in --state.

    Two processes: a supervisor, and the guard that it starts. When the guard
    dies or stands still, the supervisor stops the robot and starts it again.

    Exit code: 0 stopped, 2 bad plan.
    """
    from rtron.guard.supervision.programs import supervise  # noqa: PLC0415 - no other needs a guard

    parse_assignments(launch_arguments or ())
    if figures and not dry_run:
        help = "add --dry-run: only what nobody interferes with is worth measuring"
        raise InputError("--figures without --dry-run", help=help)
    run_writer = _run_file_writer(figures) if figures else None
    guard_plan = read_plan(plan)
    link = (
        build_link_options(guard_plan.app, service, token_file, robot, state, ca)
        if service
        else None
    )
    supervise(
        guard_plan,
        master if guard_plan.ros == 1 else _domain_address(domain),
        log_level=log_level.value.upper(),
        dry_run=dry_run,
        control=control,
        figures=run_writer,
        link=link,
    )


def _run_file_writer(path: Path) -> Callable[[MeasuredRun], None]:
    from rtron.sources.run_json import RunFileWriter  # noqa: PLC0415 - few guards keep figures

    return RunFileWriter(path.absolute())


def _domain_address(domain: int | None) -> str:
    from rtron.guard.transport.factory import domain_address  # noqa: PLC0415 - for ROS 2 alone

    return domain_address(domain_id(domain))

"""`rtron guard`."""

import logging
import socket
import sys
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from rtron.cli.support.options import DEFAULT_MASTER, Domain, Master, PlanOption
from rtron.cli.support.service_options import (
    CaOption,
    ServiceOption,
    TokenOption,
    warn_if_unencrypted,
)
from rtron.errors import InputError
from rtron.workflows.launch_arguments import parse_assignments
from rtron.workflows.live_app import app_address

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.guard.link.options import LinkOptions
    from rtron.guard.link.plan_folder import PlanFolder
    from rtron.vocabulary import InteractionGraph, MeasuredRun, Plan

log = logging.getLogger(__name__)
Robot = Annotated[
    str,
    typer.Option(metavar="NAME", envvar="RTRON_ROBOT", help="This robot's name in the service."),
]
ClientCertificate = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        envvar="RTRON_CLIENT_CERT",
        help="This robot's certificate for a service with --client-ca, PEM.",
    ),
]
ClientKey = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE", envvar="RTRON_CLIENT_KEY", help="The certificate's private key, PEM."
    ),
]
StateFolder = Annotated[
    Path | None,
    typer.Option(metavar="DIR", help="The folder for the last settings and events not yet sent."),
]


class LinkCertificates(NamedTuple):
    """The files of the link's TLS, PEM: whom it trusts, and what the guard shows."""

    ca: Path | None
    certificate: Path | None
    key: Path | None


def build_link_options(
    app: str,
    service: str,
    token_file: Path | None,
    robot: str,
    state: Path | None,
    tls: LinkCertificates,
    plans: "PlanFolder | None" = None,
) -> "LinkOptions":
    """Return the link's options, all of them checked; InputError if one cannot be used."""
    from rtron.guard.link.options import LinkOptions
    from rtron.guard.system.state_folder import state_folder

    if token_file is None:
        help = "make one with `rtron token create`, and give --token-file FILE"
        raise InputError("--service without --token-file", help=help)
    options = LinkOptions(
        service=service,
        token_file=token_file.absolute(),
        robot=robot or socket.gethostname(),
        state=(state or state_folder(app)).absolute(),
        ca=_absolute(tls.ca),
        certificate=_absolute(tls.certificate),
        key=_absolute(tls.key),
        report_command=(sys.executable, "-m", "rtron", "incident", "report"),
        plans=plans,
    )
    options.token()
    options.check_tls()
    options.prepare()
    if options.url:
        warn_if_unencrypted(service)
    return options


def _absolute(path: Path | None) -> Path | None:
    return path.absolute() if path else None


class LogLevel(str, Enum):
    """The least level that is logged to standard error."""

    DEBUG = "debug"
    INFO = "info"
    WARNING = "warning"
    ERROR = "error"


def guard(  # noqa: PLR0913 - one for each option
    launch_arguments: Annotated[
        list[str] | None,
        typer.Argument(metavar="NAME:=VALUE", help="Arguments that roslaunch appends; ignored."),
    ] = None,
    *,
    plan: PlanOption,
    graph: Annotated[
        Path | None,
        typer.Option(metavar="GRAPH.json", help="Refuse a plan that does not fit this app."),
    ] = None,
    master: Master = DEFAULT_MASTER,
    domain: Domain = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Forward every message and only report.")
    ] = False,
    measurements: Annotated[
        Path | None,
        typer.Option(metavar="RUN.json", help="Write the measurements of a dry run to a file."),
    ] = None,
    control_socket: Annotated[
        Path | None, typer.Option(metavar="SOCKET", help="The socket for `rtron override`.")
    ] = None,
    service: ServiceOption = "",
    token_file: TokenOption = None,
    robot: Robot = "",
    state_dir: StateFolder = None,
    ca: CaOption = None,
    client_cert: ClientCertificate = None,
    client_key: ClientKey = None,
    plans: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            envvar="RTRON_PLANS",
            help="Take plans of roll-outs, and keep the newest here.",
        ),
    ] = None,
    log_level: Annotated[
        LogLevel, typer.Option(help="How much to log; each line has its time, in UTC.")
    ] = LogLevel.INFO,
) -> None:
    """Run the guard: enforce a plan between the nodes of an app, until stopped.

    The guarded launch file starts it. Start it by hand to try a plan, or to
    monitor with a plan whose coordination nodes all observe.

    $ rtron guard --plan rtron.yaml
    $ rtron guard --plan rtron.yaml --graph graph.json
    $ rtron guard --plan rtron.yaml --dry-run
    $ rtron guard --plan rtron.yaml --dry-run --measurements run.json
    $ rtron guard --plan rtron.yaml --master http://robot:11311 --log-level debug
    $ rtron guard --plan rtron.yaml --domain 7       a plan with `ros: 2`
    $ rtron guard --plan rtron.yaml --service https://host:8600 --token-file F

    The guard logs what `rtron check` warns of, and refuses what it refuses.
    Without --graph it cannot know whether the plan's topics, nodes and types
    are those of the app: it waits for them.

    The guard waits for a ROS master that does not answer. In ROS 2 the
    environment sets the discovery range and the RMW. A dry run forwards every
    message; diagnostics and log report what it would have stopped, and
    `rtron plan --from-run run.json` fits the plan to the measurements.

    With --service the guard sends events to the security service and gets
    settings from its console. A separate process does this, so a slow or
    unreachable service delays nothing: the last settings stay active, and
    events wait on disk, in --state-dir.

    With --plans the service may also bring another plan, which needs no new
    launch: other policies, rules, limits, times, priorities and ranks. The
    newest accepted one is in force after each start.

    A supervisor process starts the guard. If the guard crashes or hangs, the
    supervisor stops the robot and restarts the guard.

    Exit code: 0 stopped, 2 bad plan, or one that does not fit the app.
    """
    from rtron.guard.log_format import start_logging
    from rtron.guard.supervision.programs import supervise
    from rtron.planning.plan_file.loader import read_plan

    parse_assignments(launch_arguments or ())
    if measurements and not dry_run:
        help = "add --dry-run: measurements are useful only while the guard changes nothing"
        raise InputError("--measurements without --dry-run", help=help)
    run_writer = _run_file_writer(measurements) if measurements else None
    guard_plan = read_plan(plan)
    start_logging(log_level.value.upper())
    folder = _plan_folder(plans, guard_plan, service)
    if folder:
        _, guard_plan = folder.accepted()
    _check_plan(guard_plan, graph)
    link = (
        build_link_options(
            guard_plan.app,
            service,
            token_file,
            robot,
            state_dir,
            LinkCertificates(ca, client_cert, client_key),
            folder,
        )
        if service
        else None
    )
    supervise(
        guard_plan,
        app_address(guard_plan.ros, master, domain),
        log_level=log_level.value.upper(),
        dry_run=dry_run,
        control=control_socket,
        figures=run_writer,
        link=link,
    )


def _plan_folder(folder: Path | None, start: "Plan", service: str) -> "PlanFolder | None":
    from rtron.guard.link.plan_folder import PlanFolder
    from rtron.workflows.plan import read_checked_plan

    if folder is None:
        return None
    if not service:
        raise InputError("--plans without --service", help="plans come from a service")
    made = PlanFolder(folder=folder.absolute(), start=start, read=read_checked_plan)
    made.prepare()
    return made


def _check_plan(plan: "Plan", graph: Path | None) -> None:
    """Log what is odd in a plan; InputError if it does not fit the app, where one is given."""
    from rtron.workflows.check_plan import require_fit

    for problem in require_fit(plan, _read_graph(graph) if graph else None):
        log.warning("%s: %s", problem.location, problem.message)
    if not graph:
        log.info("not checked: whether the plan's topics, nodes and types are the app's (--graph)")


def _read_graph(path: Path) -> "InteractionGraph":
    from rtron.sources.graph_json import read_graph

    return read_graph(path)


def _run_file_writer(path: Path) -> "Callable[[MeasuredRun], None]":
    from rtron.sources.run_json import RunFileWriter

    return RunFileWriter(path.absolute())

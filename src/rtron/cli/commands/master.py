"""`rtron master`."""

from typing import Annotated

import typer

from rtron.cli.commands.guard import LogLevel
from rtron.cli.support.options import PlanOption
from rtron.cli.support.outcome import Outcome
from rtron.errors import InputError, WireError

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
    from rtron.wire.ros1.host_address import advertised_host

    start_logging(log_level.value.upper())
    known = read_plan(plan)
    at = port or _master_port()
    return Outcome("", run_master(known, host or advertised_host(), at, private_port=private_port))


def _master_port() -> int:
    from rtron.wire.ros1.host_address import master_uri
    from rtron.wire.ros1.xmlrpc import split_uri

    try:
        return split_uri(master_uri())[1]
    except WireError as error:
        raise InputError(f"ROS_MASTER_URI: {error}", help="give --port") from None

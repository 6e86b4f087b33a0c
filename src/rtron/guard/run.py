"""Running the guard on ROS 1 until it is told to end."""

import gc
import logging
import resource
import signal
import sys
from pathlib import Path

from rtron.errors import SourceError
from rtron.guard.control import Answer, Control, control_path
from rtron.guard.host import Host
from rtron.guard.overriding import Overriding
from rtron.guard.senses import senses_of
from rtron.guard.transport.ros1.loop import Loop
from rtron.guard.transport.ros1.transport import Ros1Transport
from rtron.vocabulary import Plan, streams

log = logging.getLogger(__name__)

_SWITCH_S = 1e-4


def run_guard(
    plan: Plan, master: str, *, dry_run: bool = False, control: Path | None = None
) -> int:
    """Guard a plan's streams on the ROS 1 master at `master`; return the exit code.

    A dry run lets everything pass and reports what would have become of it. `control` is where
    the guard listens for overrides, by default in the user's runtime folder. SourceError if the
    plan is for ROS 2, whose transport is not there yet, or if `control` cannot be used.
    """
    if plan.ros != 1:
        raise SourceError("this guard speaks ROS 1 only", help="the plan says `ros: 2`")
    _allow_many_connections()
    loop = Loop()
    transport = Ros1Transport(loop, master)
    host = Host(transport, streams(plan), senses_of(plan), dry_run=dry_run)
    door = _door(loop, plan, control, Overriding(host, transport).answer)
    run_host(host, transport, loop)
    if door:
        door.close()
    loop.close()
    return 0


def _door(loop: Loop, plan: Plan, control: Path | None, answer: Answer) -> Control | None:
    """Open the door for overrides; where nobody chose it, the robot is guarded without one too."""
    try:
        return Control(loop, control or control_path(plan.app), answer)
    except SourceError as error:
        if control:
            raise
        log.warning("no overrides: %s", error)
        return None


def run_host(host: Host, transport: Ros1Transport, loop: Loop) -> None:
    """Guard until SIGINT, SIGTERM or a kill of the guard's own node."""

    def killed(node: str, reason: str) -> None:
        log.error("%s was shut down: %s", node, reason)
        transport.remove(node)
        if host.killed(node, reason):
            loop.stop()

    transport.killed = killed
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: loop.post(loop.stop))
    host.open()
    _favour_messages()
    log.info("guarding %d topics", len(host.guarded))
    loop.run()
    transport.close()


def _favour_messages() -> None:
    """Keep garbage collection and the threads that talk to the master out of a message's way."""
    gc.collect()
    gc.freeze()
    sys.setswitchinterval(_SWITCH_S)


def _allow_many_connections() -> None:
    _, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))

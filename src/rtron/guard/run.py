"""Running the guard on ROS 1 until it is told to end."""

import gc
import logging
import resource
import signal
import sys
from collections.abc import Sequence

from rtron.errors import SourceError
from rtron.guard.host import Host
from rtron.guard.transport.ros1.loop import Loop
from rtron.guard.transport.ros1.transport import Ros1Transport
from rtron.vocabulary import Plan, Stream, streams

log = logging.getLogger(__name__)

_SWITCH_S = 1e-4


def run_guard(plan: Plan, master: str) -> int:
    """Guard a plan's streams on the ROS 1 master at `master`; return the exit code.

    SourceError if the plan is for ROS 2, whose transport is not there yet.
    """
    if plan.ros != 1:
        raise SourceError("this guard speaks ROS 1 only", help="the plan says `ros: 2`")
    return run_streams(streams(plan), master)


def run_streams(guarded: Sequence[Stream], master: str) -> int:
    """Guard streams until SIGINT, SIGTERM or a kill of the guard's own node."""
    _allow_many_connections()
    loop = Loop()
    transport = Ros1Transport(loop, master)
    host = Host(transport, guarded)

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
    log.info("guarding %d topics on %s", len(guarded), master)
    loop.run()
    transport.close()
    loop.close()
    return 0


def _favour_messages() -> None:
    """Keep garbage collection and the threads that talk to the master out of a message's way."""
    gc.collect()
    gc.freeze()
    sys.setswitchinterval(_SWITCH_S)


def _allow_many_connections() -> None:
    _, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))

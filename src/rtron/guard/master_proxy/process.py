"""Running the master proxy until it is told to end, or until the master behind it ends."""

import logging
import signal

from rtron.errors import SourceError
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.master_proxy.master_file import MasterFile
from rtron.guard.master_proxy.rosmaster import Rosmaster
from rtron.guard.master_proxy.server import MasterProxy
from rtron.guard.system.process_attributes import allow_many_files
from rtron.guard.transport.ros1.tcp_server import TcpServer
from rtron.vocabulary import Plan
from rtron.vocabulary.topic_access import list_topic_access
from rtron.wire.ros1.network import bind_address

log = logging.getLogger(__name__)

_POLL_S = 0.2


def run_master(plan: Plan, host: str, port: int, *, private_port: int = 0) -> int:
    """Run a ROS 1 master behind a proxy at `host`:`port`; return the exit code.

    `private_port` 0 is a free one. SourceError if a port is taken, if rosmaster does not start or
    ends by itself, or if the plan is for ROS 2, which has no master.
    """
    if plan.ros != 1:
        raise SourceError("only ROS 1 has a master", help="the plan says `ros: 2`")
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.default_int_handler)
    allow_many_files()
    loop = EventLoop()
    try:
        master = Rosmaster(private_port)
        try:
            _serve(loop, plan, master, f"http://{host}:{port}/", (bind_address(host), port))
        finally:
            master.end()
    except KeyboardInterrupt:
        log.info("told to end")
    finally:
        loop.close()
    return 0


def _serve(
    loop: EventLoop, plan: Plan, master: Rosmaster, public: str, address: tuple[str, int]
) -> None:
    proxy = MasterProxy(loop, list_topic_access(plan), master.uri, public)
    server = _listen(loop, proxy, *address)
    announcement = MasterFile(server.port, master.uri)
    try:
        loop.post(lambda: _watch_master(loop, master))
        log.info("the master proxy listens at %s; %d topics are planned", public, len(proxy.topics))
        loop.run()
    finally:
        announcement.close()
        server.close()
        proxy.close()
    if master.has_ended:
        raise SourceError("rosmaster has ended, and so does the master proxy")


def _listen(loop: EventLoop, proxy: MasterProxy, address: str, port: int) -> TcpServer:
    try:
        return TcpServer(loop, address, proxy.accept, port)
    except OSError as error:
        help = "another master is running there; stop it, or choose --port"
        raise SourceError(f"port {port}: {error.strerror}", help=help) from None


def _watch_master(loop: EventLoop, master: Rosmaster) -> None:
    """Stop when the private master has ended."""
    if master.has_ended:
        loop.stop()
    else:
        loop.call_later(_POLL_S, lambda: _watch_master(loop, master))

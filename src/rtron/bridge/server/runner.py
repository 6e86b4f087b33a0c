"""Running a bridge until it is told to end."""

import logging
import os
import signal
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from rtron.bridge.common.message_types import unknown_types
from rtron.bridge.known_types import known_types
from rtron.bridge.ros1.node import Ros1NodeFactory
from rtron.bridge.server.approval_commands import ApprovalCommands, ServiceApprovals
from rtron.bridge.server.bridge import Bridge
from rtron.guard.core.control_socket import ControlSocket, control_path
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.link.bridge_requests import bridge_link_path
from rtron.guard.system.process_attributes import allow_many_files
from rtron.guard.transport.factory import open_ros2_transport

if TYPE_CHECKING:
    from rtron.bridge.common.client_node import NodeFactory
    from rtron.bridge.common.message_types import MessageTypes
    from rtron.bridge.protocol.approvals import Approvals
    from rtron.bridge.rights.document import BridgeRights
    from rtron.vocabulary import Plan

log = logging.getLogger(__name__)

BRIDGE_NODE = "/rtron_bridge"
"""The bridge's own node in ROS 2, which has neither topics nor services."""


def run_bridge(plan: "Plan", rights: "BridgeRights", address: str, host: str, port: int) -> None:
    """Serve the clients of `rights` at `host`:`port` in the graph at an address, until SIGINT.

    SourceError if the port is taken, or ROS 2 cannot be joined.
    """
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.default_int_handler)
    allow_many_files()
    loop = EventLoop()
    try:
        types, nodes = _join(plan, rights, address, loop)
        for problem in unknown_types(rights, plan.ros, types):
            log.warning("%s", problem)
        bridge = Bridge(loop, plan, rights, types, nodes)
        with closing(bridge), hearing_persons(loop, bridge.approvals, plan.app, rights):
            used = bridge.listen(host, port)
            count = len(rights.clients)
            log.info("the bridge listens at ws://%s:%d/ for %d clients", host, used, count)
            loop.run()
    except KeyboardInterrupt:
        log.info("told to end")
    finally:
        loop.close()


@contextmanager
def hearing_persons(
    loop: EventLoop, approvals: "Approvals", app: str, rights: "BridgeRights"
) -> Iterator[None]:
    """Hear persons beside the robot, and through the link process those at the service.

    That one speaks in the name of others, so at its socket not even root is heard.
    """
    beside = ApprovalCommands(approvals, loop.now)
    service = ServiceApprovals(approvals, rights.approvers, loop.now, time.time_ns)
    with ExitStack() as stack:
        for control in (
            ControlSocket(loop, bridge_control_path(app), beside.handle),
            ControlSocket(loop, bridge_link_path(app), service.handle, [os.getuid()]),
        ):
            stack.callback(control.close)
            control.open()
        yield


def bridge_control_path(app: str) -> Path:
    """Return where the bridge of an app listens for people."""
    return control_path(f"bridge_{app}")


def _join(
    plan: "Plan", rights: "BridgeRights", address: str, loop: EventLoop
) -> "tuple[MessageTypes, NodeFactory]":
    """Return the types that are known in the graph at an address, and what opens nodes there."""
    types = known_types(plan)
    if plan.ros == 1:
        return types, Ros1NodeFactory(loop, address, types, len(rights.clients))
    transport = open_ros2_transport(address, loop, node=BRIDGE_NODE)
    from rtron.bridge.ros2.node import Ros2NodeFactory  # noqa: PLC0415 - ROS 2 is not everywhere

    return types, Ros2NodeFactory(loop, transport, types)

"""The transport of the middleware that the plan names."""

from __future__ import annotations

import logging
import os
from contextlib import suppress
from importlib import import_module
from typing import TYPE_CHECKING

from rtron.errors import SourceError
from rtron.guard.cell.access import SUPERVISOR, WATCH
from rtron.guard.master_proxy.master_file import find_private_master
from rtron.guard.transport.ros1.celled_transport import CelledTransport
from rtron.guard.transport.ros1.middleware import Ros1Transport
from rtron.vocabulary import GUARD_NODE, PRIVATE_ROOT
from rtron.wire.ros2.domain_id import domain_at

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rtron.guard.core.event_loop import EventLoop
    from rtron.guard.transport.common.protocol import LiveTransport
    from rtron.guard.transport.ros2.middleware import Ros2Transport
    from rtron.vocabulary import Plan
    from rtron.wire.ros2.session import Ros2Session

log = logging.getLogger(__name__)


def share_memory(ros: int, *, on: bool) -> None:
    """Let this process use the shared memory of Fast DDS on ROS 2, or UDP alone.

    Pictures are too large for UDP; who waits for shared memory may be held up by others. Nothing
    where ROS 2 is not installed: whoever joins it then says so.
    """
    if ros != 1:
        with suppress(ImportError):
            from rtron.wire.ros2.discovery_tuning import configure_fast_dds  # noqa: PLC0415
            from rtron.wire.ros2.session import rmw_identifier  # noqa: PLC0415

            configure_fast_dds(rmw_identifier(), shares_memory=on)


def prepare_session(ros: int, address: str) -> Ros2Session | None:
    """Join the domain of an address before a guard is needed there: discovery takes a second.

    None on ROS 1, and where that fails: `open_ros2_transport` then says why.
    """
    if ros == 1:
        return None
    try:
        import_module("rtron.guard.transport.ros2.middleware")
        return _open_session(address, _spare_node())
    except Exception as error:  # noqa: BLE001 - rclpy's kinds differ
        log.debug("the domain is not joined yet: %s", error)
        return None


def load_types(ros: int, types: Iterable[str]) -> None:
    """Import the messages of some types, where that takes time. SourceError if one is unknown."""
    if ros != 1:
        from rtron.wire.ros2.interfaces import find_interface  # noqa: PLC0415

        for type in types:
            find_interface(type)


def open_transport(plan: Plan, address: str, loop: EventLoop) -> LiveTransport:
    """Return a transport for a plan at a ROS 1 master, or in a ROS 2 domain. SourceError if not.

    It is that of a supervisor, in the cells of the plan, too.
    """
    if plan.ros == 1:
        return open_ros1_transport(plan, address, loop, SUPERVISOR)
    return open_ros2_transport(address, loop, plan=plan, role=SUPERVISOR)


def open_ros1_transport(
    plan: Plan, address: str, loop: EventLoop, role: bytes = WATCH
) -> Ros1Transport:
    """Return a transport at the private master of a master's address, and in the plan's cells.

    `role` is what this process is to a cell: without a guard, the robot is stopped there.
    """
    master = find_private_master(address)
    if plan.cell:
        return CelledTransport(loop, master, plan, public=address, role=role)
    return Ros1Transport(loop, master, public=address)


def open_ros2_transport(
    address: str,
    loop: EventLoop,
    session: Ros2Session | None = None,
    *,
    plan: Plan | None = None,
    role: bytes = WATCH,
    node: str = GUARD_NODE,
) -> Ros2Transport:
    """Return a transport in the domain of an address, on the `session` that was prepared there.

    `plan` has cells, to which this process has a `role`; `node` is the first one outside.

    SourceError if it cannot be opened; see `_open_session`.
    """
    opened = session or _open_session(address, node)
    from rtron.guard.transport.ros2.celled_transport import CelledRos2Transport  # noqa: PLC0415
    from rtron.guard.transport.ros2.middleware import Ros2Transport  # noqa: PLC0415

    transport = (
        CelledRos2Transport(loop, opened, plan, address, role)
        if plan and plan.cell
        else Ros2Transport(loop, opened, node)
    )
    opened.destroy_node(_spare_node())
    return transport


def _spare_node() -> str:
    """Return the name under which this process is in the domain before it guards."""
    return f"{PRIVATE_ROOT}/spare_{os.getpid()}"


def _open_session(address: str, node: str) -> Ros2Session:
    """Join the domain of an address with a first node.

    SourceError if ROS 2 is not installed here, if its structures have another layout than the guard
    reads, or if its RMW does not tell who sent a message.
    """
    try:
        from rtron.guard.transport.ros2.abi_check import check_abi  # noqa: PLC0415
        from rtron.wire.ros2.discovery_tuning import (  # noqa: PLC0415
            configure_cyclone,
            configure_fast_dds,
        )
        from rtron.wire.ros2.session import Ros2Session, rmw_identifier  # noqa: PLC0415
    except ImportError as error:
        help = "pip install 'rtron[ros2]', or source your ROS 2"
        raise SourceError(f"ROS 2 is not there: {error}", help=help) from error
    configure_fast_dds(rmw_identifier())
    configure_cyclone()
    session = Ros2Session(domain_at(address))
    try:
        check_abi(session.node(node))
    except SourceError:
        session.close()
        raise
    return session

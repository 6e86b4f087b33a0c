"""The transport of the middleware that the plan names."""

from __future__ import annotations

from contextlib import suppress
from importlib import import_module
from typing import TYPE_CHECKING

from rtron.errors import SourceError
from rtron.guard.master_proxy.master_file import find_private_master
from rtron.guard.transport.ros1.middleware import Ros1Transport
from rtron.vocabulary import GUARD_NODE
from rtron.wire.ros2.domain_id import domain_at

if TYPE_CHECKING:
    from rtron.guard.core.event_loop import EventLoop
    from rtron.guard.transport.common.protocol import LiveTransport
    from rtron.guard.transport.ros2.middleware import Ros2Transport

_RMW_PREFIX = "rmw_fastrtps"


def load_middleware(ros: int) -> None:
    """Import the modules of `open_transport`, which reports what is missing."""
    if ros != 1:
        with suppress(ImportError):
            import_module("rtron.guard.transport.ros2.middleware")


def open_transport(ros: int, address: str, loop: EventLoop) -> LiveTransport:
    """Return a transport for ROS 1 at a master, or for ROS 2 in a domain. SourceError if not."""
    return open_ros1_transport(address, loop) if ros == 1 else open_ros2_transport(address, loop)


def open_ros1_transport(address: str, loop: EventLoop) -> Ros1Transport:
    """Return a transport at the private master of a master's address."""
    return Ros1Transport(loop, find_private_master(address), public=address)


def open_ros2_transport(address: str, loop: EventLoop) -> Ros2Transport:
    """Return a transport in the domain of an address.

    SourceError if ROS 2 is not installed here, if its structures have another layout than the guard
    reads, or if its RMW is not Fast DDS: with another one, the publisher's id in a message differs
    from its id in the graph.
    """
    try:
        from rtron.guard.transport.ros2.abi_check import check_abi  # noqa: PLC0415
        from rtron.guard.transport.ros2.middleware import Ros2Transport  # noqa: PLC0415
        from rtron.wire.ros2.discovery_tuning import enable_fast_announcements  # noqa: PLC0415
        from rtron.wire.ros2.session import Ros2Session, rmw_identifier  # noqa: PLC0415
    except ImportError as error:
        help = "pip install 'rtron[ros2]', or source your ROS 2"
        raise SourceError(f"ROS 2 is not there: {error}", help=help) from error
    if not (rmw := rmw_identifier()).startswith(_RMW_PREFIX):
        help = "export RMW_IMPLEMENTATION=rmw_fastrtps_cpp for the whole app"
        raise SourceError(f"the guard cannot tell publishers apart with {rmw}", help=help)
    enable_fast_announcements()
    session = Ros2Session(domain_at(address))
    try:
        check_abi(session.node(GUARD_NODE))
    except SourceError:
        session.close()
        raise
    return Ros2Transport(loop, session)

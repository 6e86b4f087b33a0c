"""The transport of the middleware that the plan names."""

from __future__ import annotations

import logging
import os
from importlib import import_module
from typing import TYPE_CHECKING

from rtron.errors import SourceError
from rtron.guard.master_proxy.master_file import find_private_master
from rtron.guard.transport.ros1.middleware import Ros1Transport
from rtron.vocabulary import GUARD_NODE, PRIVATE_ROOT
from rtron.wire.ros2.domain_id import domain_at

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rtron.guard.core.event_loop import EventLoop
    from rtron.guard.transport.common.protocol import LiveTransport
    from rtron.guard.transport.ros2.middleware import Ros2Transport
    from rtron.wire.ros2.session import Ros2Session

log = logging.getLogger(__name__)


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


def open_transport(ros: int, address: str, loop: EventLoop) -> LiveTransport:
    """Return a transport for ROS 1 at a master, or for ROS 2 in a domain. SourceError if not."""
    return open_ros1_transport(address, loop) if ros == 1 else open_ros2_transport(address, loop)


def open_ros1_transport(address: str, loop: EventLoop) -> Ros1Transport:
    """Return a transport at the private master of a master's address."""
    return Ros1Transport(loop, find_private_master(address), public=address)


def open_ros2_transport(
    address: str, loop: EventLoop, session: Ros2Session | None = None
) -> Ros2Transport:
    """Return a transport in the domain of an address, on the `session` that was prepared there.

    SourceError if it cannot be opened; see `_open_session`.
    """
    opened = session or _open_session(address, GUARD_NODE)
    from rtron.guard.transport.ros2.middleware import Ros2Transport  # noqa: PLC0415

    transport = Ros2Transport(loop, opened)
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
            enable_fast_announcements,
        )
        from rtron.wire.ros2.session import Ros2Session  # noqa: PLC0415
    except ImportError as error:
        help = "pip install 'rtron[ros2]', or source your ROS 2"
        raise SourceError(f"ROS 2 is not there: {error}", help=help) from error
    enable_fast_announcements()
    configure_cyclone()
    session = Ros2Session(domain_at(address))
    try:
        check_abi(session.node(node))
    except SourceError:
        session.close()
        raise
    return session

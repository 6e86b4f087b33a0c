"""The objects that all endpoints of the transport share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.guard.core.event_loop import EventLoop
    from rtron.guard.transport.ros2.graph import RosGraph
    from rtron.guard.transport.ros2.participants import NameOwners, ParticipantLiveness
    from rtron.guard.transport.ros2.rcl import Rcl
    from rtron.guard.transport.ros2.sender_ids import SenderIds


@dataclass(slots=True)
class TransportContext:
    """The event loop, rcl and its senders' ids, the graph, the owners of its names, their liveness.

    `report_unreadable` takes a topic, a node, and why a message of that node cannot be read.
    """

    loop: EventLoop
    rcl: Rcl
    sender_ids: SenderIds
    graph: RosGraph
    owners: NameOwners
    liveness: ParticipantLiveness
    report_unreadable: Callable[[str, str, str], None]

"""What all ends of the transport share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.guard.core.event_loop import EventLoop
    from rtron.guard.transport.ros2.graph import RosGraph
    from rtron.guard.transport.ros2.participants import NameOwners, ParticipantLiveness
    from rtron.guard.transport.ros2.rcl import Rcl


@dataclass(slots=True)
class TransportContext:
    """The loop, rcl's calls, the graph, whose the node names in it are, and who of it lives.

    `report_unreadable` is told what of a node's words on a topic is not heard, and why.
    """

    loop: EventLoop
    rcl: Rcl
    graph: RosGraph
    owners: NameOwners
    liveness: ParticipantLiveness
    report_unreadable: Callable[[str, str, str], None]

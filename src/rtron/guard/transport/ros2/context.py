"""What all ends of the transport share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.guard.core.event_loop import Loop
    from rtron.guard.transport.ros2.graph import Graph
    from rtron.guard.transport.ros2.owners import Owners
    from rtron.guard.transport.ros2.participants import Lives
    from rtron.guard.transport.ros2.rcl import Rcl


@dataclass(slots=True)
class Surroundings:
    """The loop, rcl's calls, the graph, whose the node names in it are, and who of it lives.

    `complain` is told what of a node's words on a topic is not heard, and why.
    """

    loop: Loop
    rcl: Rcl
    graph: Graph
    owners: Owners
    lives: Lives
    complain: Callable[[str, str, str], None]

"""What all ends of the transport share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rtron.guard.loop import Loop
    from rtron.guard.transport.ros2.graph import Graph
    from rtron.guard.transport.ros2.owners import Owners
    from rtron.guard.transport.ros2.rcl import Rcl


@dataclass(frozen=True, slots=True)
class Surroundings:
    """The loop, rcl's calls, the graph, and whose the node names in it are."""

    loop: Loop
    rcl: Rcl
    graph: Graph
    owners: Owners

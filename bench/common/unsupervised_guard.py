"""A guard in one process, without a supervisor."""

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.rehearsal import Rehearsal
from rtron.guard.runner import INTERRUPTS, GraphPart, Part, run_parts
from rtron.guard.transport.common.protocol import LiveTransport


def run_coordinator(
    coordinator: Coordinator, transport: LiveTransport, loop: EventLoop, *audit: Part
) -> None:
    """Guard until told to end."""
    graph = GraphPart(coordinator.open, transport)
    rehearsal = Rehearsal(coordinator, loop, transport.create_stage())
    run_parts(loop, [graph, *audit, rehearsal], until=INTERRUPTS)

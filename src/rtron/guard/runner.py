"""Running a process of the guard until it is ended: what all of them do."""

from __future__ import annotations

import gc
import logging
import signal
import sys
from typing import TYPE_CHECKING, Protocol

from rtron.errors import SourceError
from rtron.guard.core.control_socket import ControlSocket, RequestHandler, control_path

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence
    from pathlib import Path

    from rtron.guard.core.event_loop import EventLoop
    from rtron.guard.transport.common.protocol import LiveTransport
    from rtron.vocabulary import Plan

log = logging.getLogger(__name__)

_SWITCH_S = 1e-4
INTERRUPTS = signal.SIGINT, signal.SIGTERM
"""What ends a process that stands alone."""


class Part(Protocol):
    """Something that is opened before the loop runs, and closed after it."""

    def open(self) -> None:
        """Begin."""
        ...

    def close(self) -> None:
        """End."""
        ...


def run_parts(
    loop: EventLoop, parts: Sequence[Part], *, until: Collection[int] = (signal.SIGTERM,)
) -> None:
    """Open `parts`, run the loop until one of these signals, then close them, the last one first.

    SIGINT is the supervisor's, where there is one: it ends the processes in order.
    """
    for number in until:
        signal.signal(number, lambda *_: loop.post(loop.stop))
    for part in parts:
        part.open()
    _reduce_latency()
    loop.run()
    for part in reversed(parts):
        part.close()
    loop.close()


class GraphPart:
    """The nodes of a process: `open` lets them join the graph."""

    def __init__(self, open: Callable[[], None], transport: LiveTransport) -> None:
        self.open = open
        self.close = transport.close


def open_control_socket(
    loop: EventLoop, plan: Plan, control: Path | None, handler: RequestHandler
) -> ControlSocket | None:
    """Open the socket for overrides; the guard runs without one, unless `control` names it."""
    try:
        return ControlSocket(loop, control or control_path(plan.app), handler)
    except SourceError as error:
        if control:
            raise
        unreachable = "`rtron override` and `rtron clear` do not reach this guard: %s; %s"
        log.error(unreachable, error, error.help)  # noqa: TRY400 - no fault of RTron's
        return None


def _reduce_latency() -> None:
    """Keep garbage collection and the threads of the master's calls from delaying messages."""
    gc.collect()
    gc.freeze()
    sys.setswitchinterval(_SWITCH_S)

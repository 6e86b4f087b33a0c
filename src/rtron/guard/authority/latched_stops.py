"""The latched stop of a guard: what sources have stopped keeps standing until persons release it.

What is latched is in the handover state at once, for the next guard, and in a file of the user's
state folder soon after, for the time after the supervisor.
"""

import logging
import time
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from rtron.errors import RTronError
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.handover_state import STOPS, HandoverState
from rtron.guard.core.state_file import StateFile
from rtron.guard.settings.applier import can_move_robot
from rtron.guard.system.state_folder import master_file_name, state_folder
from rtron.guard.transport.common.protocol import Transport
from rtron.policies.authority.stop_latch import StopAnswer, StopLatch
from rtron.vocabulary import SECOND, Plan

if TYPE_CHECKING:
    from rtron.guard.core.stream import GuardedStream

log = logging.getLogger(__name__)

_BRAKE = "latched stop"
_SAVE_TIMEOUT = SECOND
"""How long the answer to a stop waits for the disk before it says that it is slow, ns."""
_LOOK_AGAIN = SECOND // 100


class LatchedStops:
    """Brakes all that can move the robot while a source has stopped it."""

    def __init__(self, coordinator: Coordinator, transport: Transport, plan: Plan) -> None:
        self._latch = StopLatch(plan.stop_sources.second_person)
        self._buttons = frozenset(button.name for button in plan.stop_sources.buttons)
        self._streams: list[GuardedStream] = list(filter(can_move_robot, coordinator.streams))
        self._transport = transport
        self._store: Callable[[dict[str, Any]], None] = lambda state: None
        self._file: StateFile | None = None

    @property
    def has_effect(self) -> bool:
        """Whether there is a stream that a stop can brake."""
        return bool(self._streams)

    @property
    def stops(self) -> dict[str, dict[str, Any]]:
        """What is not released, by source: who has stopped it, why, and since when (ns)."""
        return self._latch.export_state()

    def keep(self, handover: HandoverState, file: StateFile) -> None:
        """Latch what was latched before, and keep from now on what is; call it before the open."""
        inherited = handover.inherited(STOPS)
        state = {**_read(file), **(inherited if isinstance(inherited, dict) else {})}
        self._latch.restore_state(state, time.time_ns(), self._buttons)
        self._store = partial(_store, handover, file)
        self._file = file
        if state:
            log.error("still stopped, nobody has released it: %s", self._latch.reason)
            self._apply()

    def stop(self, source: str, by: str, reason: str, *, is_caused: bool = False) -> None:
        """Stop the robot until the source is released."""
        if self._latch.stop(source, by, reason, time.time_ns(), is_caused=is_caused):
            self._apply()
            log.error("stopped by %s: %s, %s", source, by, reason)

    def end_cause(self, source: str) -> None:
        """Note that what has caused the stop of a source is gone."""
        self._latch.end_cause(source)

    def release(self, source: str, by: str, reason: str) -> StopAnswer:
        """Release the stop of a source; the robot moves again when all are released."""
        now = self._transport.now()
        inputs = (each.stop_controller.moving_input(now) for each in self._streams)
        moving = next(filter(None, inputs), "")
        answer = self._latch.release(source, by, reason, time.time_ns(), moving=moving)
        log.warning("release of %s by %s: %s", source, by, answer.reason)
        if answer.released:
            self._apply()
        return answer

    def call_when_saved(self, done: Callable[[str], None]) -> None:
        """Call `done` as soon as the disk has what is stopped, with "", or why it has it not yet.

        Why not comes as soon as it is known, and after a second at the latest.
        """
        self._await_file(done, self._transport.now() + _SAVE_TIMEOUT)

    def _await_file(self, done: Callable[[str], None], until: int) -> None:
        now = self._transport.now()
        if self._file is None or self._file.is_saved:
            done("")
        elif self._file.failure or now >= until:
            done(self._file.failure or "the disk is slow")
        else:
            self._transport.call_at(now + _LOOK_AGAIN, partial(self._await_file, done, until))

    def hold(self, by: str, why: str) -> None:
        """Brake without a latch, until `let_go(by)`."""
        for stream in self._streams:
            stream.brake(by, why)

    def let_go(self, by: str) -> None:
        """End such a brake."""
        for stream in self._streams:
            stream.release(by)

    def _apply(self) -> None:
        """Brake for what is latched, or let go if nothing is; keep it."""
        reason = self._latch.reason
        for stream in self._streams:
            if reason:
                stream.brake(_BRAKE, f"{_BRAKE}: {reason}")
            else:
                stream.release(_BRAKE)
        self._store(self._latch.export_state())


def stop_file(plan: Plan, master: str) -> StateFile:
    """Return the file of a guard at a master or in a domain."""
    path = state_folder(plan.app) / "stops" / f"{master_file_name(master)}.json"
    return StateFile(path, "what is stopped is not kept for the time after a reboot")


def _read(file: StateFile) -> dict[str, Any]:
    """Return what was latched; a file that cannot be read is a source of its own."""
    try:
        return file.read()
    except (OSError, ValueError, RTronError) as error:
        log.error("%s: what was stopped cannot be read: %s", file.path, error)  # noqa: TRY400
        return {"file": {"by": "the guard", "reason": f"{file.path} cannot be read"}}


def _store(handover: HandoverState, file: StateFile, state: dict[str, Any]) -> None:
    handover.store(STOPS, state or None)
    file.save(state)

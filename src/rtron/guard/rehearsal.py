"""Keeps the way of commands warm: a copy of each stream handles its last message while all is idle.

A message every 5 ms finds the caches cold and takes several times as long as one right behind
another. So once a millisecond, where the loop has nothing else to do, the last message of a stream
goes through a copy of it once more. Nothing of the copy reaches the app, the stream or its counts.
The loop looks for events before each part, and a rehearsal that is interrupted goes on later: a
message waits for the rest of one part at most.
"""

import logging
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial
from itertools import count

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.core.observations import Observations
from rtron.guard.core.stream import GuardedStream
from rtron.guard.core.stream_endpoints import StreamContext
from rtron.guard.transport.common.memory import Stage
from rtron.policies.mission.rule_status import MissionMonitor
from rtron.vocabulary import SECOND, UNAPPROVED, Stream

log = logging.getLogger(__name__)

PERIOD = SECOND // 1000
SHARE = 10
"""A rehearsal takes at most a tenth of the time."""
_ACTIVE = SECOND
"""How long after its last command a stream is rehearsed."""
_LOOK_PERIOD = SECOND // 20
_MAX_BYTES = 1 << 10
"""Longer messages are not rehearsed: their parts would take too long."""


class Rehearsal:
    """Rehearses the streams of a coordinator in turn, those that move the robot now."""

    def __init__(self, coordinator: Coordinator, loop: EventLoop, stage: Stage) -> None:
        self._coordinator = coordinator
        self._loop = loop
        self._stage = stage
        self._turn = count()
        self._copies: dict[GuardedStream, _StreamCopy] = {}
        self._parts: list[Callable[[], None]] = []
        self._took = 0
        self._has_failed = False
        self.finished = 0
        """How many rehearsals came to their end."""

    def open(self) -> None:
        """Begin a rehearsal, or go on with one, as soon as the loop is idle; and again later."""
        pause = max(PERIOD, SHARE * self._took)
        if not self._parts:
            self._parts = self._next_parts()
        if self._parts:
            self._loop.call_when_idle(self._play)
        self._loop.call_at(self._loop.now() + (pause if self._parts else _LOOK_PERIOD), self.open)

    def close(self) -> None:
        """Let go of the stage."""
        self._stage.close()

    def _next_parts(self) -> list[Callable[[], None]]:
        """Return what is to be done for the stream whose turn it is; nothing if all are silent."""
        streams = () if self._has_failed else self._coordinator.streams
        for _ in streams:
            stream = streams[next(self._turn) % len(streams)]
            if self._is_active(stream):
                self._took = 0
                return list(self._parts_of(stream))
        return []

    def _is_active(self, stream: GuardedStream) -> bool:
        """Tell whether a stream moves the robot and had a command of a known flow just now."""
        last = stream.pipeline.last_emitted
        if last is None or type(stream) is not GuardedStream or not stream.stop_controller.is_ready:
            return False
        flow, message, at = last
        is_short = len(message) <= _MAX_BYTES
        return is_short and flow != UNAPPROVED and self._loop.now() - at < _ACTIVE

    def _parts_of(self, stream: GuardedStream) -> Iterable[Callable[[], None]]:
        flow, message, _ = stream.pipeline.last_emitted or ("", b"", 0)
        copy = self._copies.get(stream)
        if copy is None or copy.planned is not stream.spec:
            yield partial(self._copy, stream)
            return
        yield partial(self._stage.arrive, message)
        yield partial(self._stage.handle, partial(copy.receive, flow))
        yield self._stage.take_output

    def _copy(self, stream: GuardedStream) -> None:
        """Copy a stream that is new, or has new settings; a rehearsal of its own."""
        observations = self._coordinator.observations
        self._copies[stream] = _StreamCopy(stream, observations, self._stage)

    def _play(self) -> None:
        """Do the next part, and the one behind it if the loop is still idle then."""
        began = self._loop.now()
        part, *rest = self._parts
        try:
            part()
        except MemoryError:
            raise
        except Exception:
            log.exception("internal error: the way of commands is not kept warm any more")
            self._parts, self._has_failed = [], True
            return
        self._parts = rest
        self._took += self._loop.now() - began
        if rest:
            self._loop.call_when_idle(self._play)
        else:
            self.finished += 1


class _StreamCopy(GuardedStream):
    """A stream as it is planned, with policies of its own, whose messages go nowhere."""

    def __init__(self, stream: GuardedStream, observations: Observations, stage: Stage) -> None:
        still = replace(observations, mission=_StillMission(observations.mission))
        super().__init__(stream.spec, StreamContext(stage, still, HandoverState()))
        self.planned: Stream = stream.spec
        self.learn_codec(stream.codec)
        self.endpoints.outputs.open()

    def _is_neutral(self, message: object) -> bool:  # noqa: ARG002
        """Take the message for neutral: the stream has passed it already."""
        return True


class _StillMission(MissionMonitor):
    """The rules of a mission as they stand: a rehearsal neither updates nor meets them."""

    def __init__(self, mission: MissionMonitor) -> None:
        super().__init__(mission.bits)
        self.statuses = mission.statuses

    def update(self, now: int) -> None:
        """Leave the rules as they are."""

    def mark_met(self, rules: Iterable[str]) -> None:
        """Leave the rules as they are."""

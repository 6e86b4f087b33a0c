"""What the flows of one stream do, message by message, in a memory that does not grow with time."""

from rtron.errors import WireError
from rtron.guard.action.ros2.endpoints import GoalMessage
from rtron.guard.measurement.flow import MeasuredFlow
from rtron.guard.measurement.frame_rates import MeasuredRates
from rtron.guard.measurement.histogram import Histogram, value_figures
from rtron.messages.common.velocity import VelocityCodec
from rtron.messages.ros1.actions import read_goal
from rtron.vocabulary import (
    UNAPPROVED,
    Decision,
    Flow,
    Mode,
    Stream,
    StreamFigures,
    Velocity,
    Verdict,
)

MOST_COMPARED = 32
"""Overlaps are measured between so many flows of a stream."""

MOST_OPEN = 100
"""So many goals, and so many held messages, are waited for."""


class MeasuredStream:
    """Measures one stream; the guard tells it what arrives, what goes and what is done."""

    def __init__(self, stream: Stream, rates: MeasuredRates) -> None:
        stranger = Flow(name=UNAPPROVED, publisher="*")
        self._stream = stream
        self._flows = {each.name: MeasuredFlow(each) for each in (*stream.flows, stranger)}
        self._speaking: dict[str, MeasuredFlow] = {}
        self._rates = rates
        self._codec: VelocityCodec | None = None
        self._per_frame = Histogram[float]()
        self._unseen = 0
        self._held: dict[int, tuple[bytes, MeasuredFlow, int]] = {}
        self._named = bool(stream.action) and stream.mode is Mode.ENFORCE
        self._goals: dict[bytes, tuple[MeasuredFlow, int]] = {}

    def learn(self, codec: VelocityCodec) -> None:
        """Take how the stream's messages are laid out."""
        self._codec = codec

    def heard(self, name: str, message: bytes, now: int, verdict: Verdict | None) -> None:
        """Note a message of a flow, and what the pipeline says of it."""
        flow = self._flows[name]
        gap = flow.heard(now)
        if gap:
            self._overlap(flow, gap, now)
        if self._codec is not None:
            self._look(flow, self._codec, message, now)
        if self._named or self._stream.done:
            self._open(flow, message, now)
        if verdict is not None and verdict.decision is not Decision.PASS:
            flow.refused(verdict)
            if verdict.decision is Decision.HOLD:
                self._hold(flow, message, now)

    def passed(self, message: bytes, now: int) -> None:
        """Note that a message has passed every stage, at once or after it was held."""
        held = self._held.pop(id(message), None)
        if held is not None:
            _, flow, arrived = held
            flow.waits.add(now - arrived)

    def done(self, now: int) -> None:
        """Note that a goal without an id is done: the last, no other is known to be open."""
        if not self._named:
            self.finished(b"", now)

    def finished(self, goal: bytes, now: int) -> None:
        """Note that the goal with this id is done."""
        found = self._goals.pop(goal, None)
        if found is not None:
            flow, asked = found
            flow.takes.add(now - asked)

    def figures(self, now: int, strangers: tuple[str, ...]) -> StreamFigures:
        """Return what was measured until `now`."""
        undone = [flow for flow, _ in self._goals.values()]
        flows = [flow for flow in self._flows.values() if flow.flow.name != UNAPPROVED]
        stranger = self._flows[UNAPPROVED]
        if stranger.messages:
            flows.append(stranger)
        return StreamFigures(
            topic=self._stream.topic,
            mode=Mode(self._stream.mode),
            flows=tuple(flow.figures(now, undone.count(flow)) for flow in flows),
            per_frame=value_figures(self._per_frame),
            unseen=self._unseen,
            strangers=strangers,
        )

    def _overlap(self, flow: MeasuredFlow, gap: int, now: int) -> None:
        name = flow.flow.name
        if name not in self._speaking and len(self._speaking) >= MOST_COMPARED:
            return
        self._speaking[name] = flow
        for other in self._speaking.values():
            if other is not flow and other.speaks(now):
                flow.overlap(other.flow.name, gap)

    def _look(self, flow: MeasuredFlow, codec: VelocityCodec, message: bytes, now: int) -> None:
        try:
            velocity = codec.decode(message)
        except WireError:
            return
        if velocity.finite:
            flow.asked(velocity, moves=velocity.moves and not codec.is_limit)
            self._compare(flow, velocity, now)

    def _compare(self, flow: MeasuredFlow, velocity: Velocity, now: int) -> None:
        """Note how far the robot would go in the time of a frame."""
        if not self._rates.monitors or flow.flow.name == UNAPPROVED:
            return
        if self._rates.silent(now):
            self._unseen += 1
        elif fps := self._rates.least(now):
            self._per_frame.add(velocity.speed / fps)

    def _hold(self, flow: MeasuredFlow, message: bytes, now: int) -> None:
        """Keep a held message, so that its id is nobody else's; the oldest makes room."""
        if len(self._held) >= MOST_OPEN:
            del self._held[next(iter(self._held))]
        self._held[id(message)] = (message, flow, now)

    def _open(self, flow: MeasuredFlow, message: bytes, now: int) -> None:
        """Wait for the end of a goal; of those without ids, for one: which ended is not told."""
        try:
            goal = _goal_id(message) if self._named else b""
        except WireError:
            return
        if goal in self._goals or len(self._goals) >= MOST_OPEN:
            oldest = goal if goal in self._goals else next(iter(self._goals))
            forgotten, _ = self._goals.pop(oldest)
            forgotten.undone += 1
        self._goals[goal] = (flow, now)


def _goal_id(message: bytes) -> bytes:
    """Return the id of a goal of either ROS."""
    return message.id if isinstance(message, GoalMessage) else read_goal(message).id

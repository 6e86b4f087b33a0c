"""Figures of one stream, message by message, in a memory that does not grow with time."""

from rtron.errors import WireError
from rtron.guard.measurement.activity import ActivityPhases
from rtron.guard.measurement.frame_rates import FrameRateMeasurement
from rtron.guard.measurement.histogram import Histogram, duration_figures, value_figures
from rtron.messages.common.velocity import VelocityCodec
from rtron.messages.ros1.actions import read_goal
from rtron.messages.ros2.actions import GoalMessage
from rtron.vocabulary import (
    UNAPPROVED,
    Decision,
    Flow,
    FlowStatistics,
    Mode,
    OverlapStatistics,
    PolicyName,
    RefusalStatistics,
    Stream,
    StreamStatistics,
    Velocity,
    Verdict,
)

MOST_COMPARED = 32
"""The number of flows of a stream whose overlaps are measured."""

MOST_OPEN = 100
"""The number of open goals, and of held messages, that are remembered."""

_LONGEST_REASON = 200


class FlowMeasurement:
    """The figures of one flow as they grow."""

    __slots__ = (
        "_activity",
        "_left_moving",
        "_moving",
        "_overlaps",
        "_refusals",
        "_speeds",
        "flow",
        "takes",
        "undone",
        "waits",
    )

    def __init__(self, flow: Flow) -> None:
        self.flow = flow
        self.waits = Histogram[int]()
        self.takes = Histogram[int]()
        self.undone = 0
        self._activity = ActivityPhases()
        self._speeds = Histogram[float]()
        self._moving = False
        self._left_moving = 0
        self._overlaps: dict[str, int] = {}
        self._refusals: dict[tuple[PolicyName, Decision], tuple[int, Verdict]] = {}

    @property
    def messages(self) -> int:
        """How many messages came."""
        return self._activity.messages

    def add_message(self, now: int) -> int | None:
        """Note a message; return the gap (ns) before it, None if a phase begins."""
        gap = self._activity.add_message(now)
        if gap is None and self._moving:
            self._left_moving += 1
        return gap

    def is_active(self, now: int) -> bool:
        """Return whether the flow is in the midst of a phase."""
        return self._activity.is_active(now)

    def add_overlap(self, other: str, duration: int) -> None:
        """Note that another flow was active at the same time."""
        self._overlaps[other] = self._overlaps.get(other, 0) + duration

    def add_velocity(self, velocity: Velocity, *, moves: bool) -> None:
        """Note a velocity; `moves` says whether the robot moves with it."""
        self._speeds.add(velocity.speed)
        self._moving = moves

    def add_refusal(self, verdict: Verdict) -> None:
        """Note a verdict that a message would not have passed unchanged."""
        key = verdict.policy, verdict.decision
        count, _ = self._refusals.get(key, (0, verdict))
        self._refusals[key] = count + 1, verdict

    def figures(self, now: int, still_open: int) -> FlowStatistics:
        """Return the figures until `now`."""
        gaps, pauses = self._activity.gaps_and_pauses()
        return FlowStatistics(
            flow=self.flow.name,
            publisher=self.flow.publisher,
            messages=self.messages,
            gaps=duration_figures(gaps),
            pauses=duration_figures(pauses),
            active=gaps.total(0),
            left_moving=self._left_moving + (self._moving and self._activity.is_over(now)),
            waits=duration_figures(self.waits),
            takes=duration_figures(self.takes),
            undone=self.undone + still_open,
            speeds=value_figures(self._speeds),
            refusals=tuple(_refusal_figures(*each) for each in self._refusals.values()),
            overlaps=tuple(
                OverlapStatistics(flow=k, duration=v) for k, v in self._overlaps.items()
            ),
        )


def _refusal_figures(count: int, last: Verdict) -> RefusalStatistics:
    return RefusalStatistics(
        policy=last.policy,
        decision=last.decision,
        count=count,
        reason=last.reason[:_LONGEST_REASON],
    )


class StreamMeasurement:
    """Measures one stream; the guard reports each message, each output and each finished goal."""

    def __init__(self, stream: Stream, rates: FrameRateMeasurement) -> None:
        unapproved = Flow(name=UNAPPROVED, publisher="*")
        self._stream = stream
        self._flows = {each.name: FlowMeasurement(each) for each in (*stream.flows, unapproved)}
        self._active_flows: dict[str, FlowMeasurement] = {}
        self._rates = rates
        self._codec: VelocityCodec | None = None
        self._per_frame = Histogram[float]()
        self._commands_without_frames = 0
        self._held: dict[int, tuple[bytes, FlowMeasurement, int]] = {}
        self._has_goal_ids = bool(stream.action) and stream.mode is Mode.ENFORCE
        self._goals: dict[bytes, tuple[FlowMeasurement, int]] = {}

    def learn(self, codec: VelocityCodec) -> None:
        """Take the codec of the stream's messages."""
        self._codec = codec

    def add_message(self, name: str, message: bytes, now: int, verdict: Verdict | None) -> None:
        """Note a message of a flow, and the pipeline's verdict."""
        flow = self._flows[name]
        gap = flow.add_message(now)
        if gap:
            self._overlap(flow, gap, now)
        if self._codec is not None:
            self._measure_velocity(flow, self._codec, message, now)
        if self._has_goal_ids or self._stream.done:
            self._open_goal(flow, message, now)
        if verdict is not None and verdict.decision is not Decision.PASS:
            flow.add_refusal(verdict)
            if verdict.decision is Decision.HOLD:
                self._add_held(flow, message, now)

    def add_passed(self, message: bytes, now: int) -> None:
        """Note that a message has passed every stage, at once or after it was held."""
        held = self._held.pop(id(message), None)
        if held is not None:
            _, flow, arrived = held
            flow.waits.add(now - arrived)

    def finish_goal_without_id(self, now: int) -> None:
        """Note that the goal without an id is done; at most one is open."""
        if not self._has_goal_ids:
            self.finish_goal(b"", now)

    def finish_goal(self, goal: bytes, now: int) -> None:
        """Note that the goal with this id is done."""
        entry = self._goals.pop(goal, None)
        if entry is not None:
            flow, start_time = entry
            flow.takes.add(now - start_time)

    def figures(self, now: int, strangers: tuple[str, ...]) -> StreamStatistics:
        """Return the figures until `now`."""
        undone = [flow for flow, _ in self._goals.values()]
        flows = [flow for flow in self._flows.values() if flow.flow.name != UNAPPROVED]
        unapproved = self._flows[UNAPPROVED]
        if unapproved.messages:
            flows.append(unapproved)
        return StreamStatistics(
            topic=self._stream.topic,
            mode=Mode(self._stream.mode),
            flows=tuple(flow.figures(now, undone.count(flow)) for flow in flows),
            per_frame=value_figures(self._per_frame),
            unseen=self._commands_without_frames,
            strangers=strangers,
        )

    def _overlap(self, flow: FlowMeasurement, gap: int, now: int) -> None:
        name = flow.flow.name
        if name not in self._active_flows and len(self._active_flows) >= MOST_COMPARED:
            return
        self._active_flows[name] = flow
        for other in self._active_flows.values():
            if other is not flow and other.is_active(now):
                flow.add_overlap(other.flow.name, gap)

    def _measure_velocity(
        self, flow: FlowMeasurement, codec: VelocityCodec, message: bytes, now: int
    ) -> None:
        try:
            velocity = codec.decode(message)
        except WireError:
            return
        if velocity.is_finite:
            flow.add_velocity(velocity, moves=velocity.is_moving and not codec.is_limit)
            self._measure_distance_per_frame(flow, velocity, now)

    def _measure_distance_per_frame(
        self, flow: FlowMeasurement, velocity: Velocity, now: int
    ) -> None:
        """Note how far the robot moves during one frame."""
        if not self._rates.monitors or flow.flow.name == UNAPPROVED:
            return
        if self._rates.is_silent(now):
            self._commands_without_frames += 1
        elif fps := self._rates.least(now):
            self._per_frame.add(velocity.speed / fps)

    def _add_held(self, flow: FlowMeasurement, message: bytes, now: int) -> None:
        """Keep a held message, so that its `id()` stays its own; the oldest makes room."""
        if len(self._held) >= MOST_OPEN:
            del self._held[next(iter(self._held))]
        self._held[id(message)] = (message, flow, now)

    def _open_goal(self, flow: FlowMeasurement, message: bytes, now: int) -> None:
        """Remember a goal until its end; of goals without an id, only the last."""
        try:
            goal = _goal_id(message) if self._has_goal_ids else b""
        except WireError:
            return
        if goal in self._goals or len(self._goals) >= MOST_OPEN:
            oldest = goal if goal in self._goals else next(iter(self._goals))
            oldest_flow, _ = self._goals.pop(oldest)
            oldest_flow.undone += 1
        self._goals[goal] = (flow, now)


def _goal_id(message: bytes) -> bytes:
    """Return the id of a goal of either ROS."""
    return message.id if isinstance(message, GoalMessage) else read_goal(message).id

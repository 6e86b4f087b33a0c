"""A Stream: all that governs one topic, as one pipeline in the order GRCN, MSRCN, RSRCN."""

from dataclasses import dataclass

from rtron.vocabulary.action import action_name
from rtron.vocabulary.enums import CoordinationKind, Mode, PolicyName, StreamKind
from rtron.vocabulary.plan import SECOND, Flow, StopProfile


@dataclass(frozen=True, slots=True, kw_only=True)
class StageRule:
    """A rule of the mission on one topic: the flows it blocks, and those that meet what it asks."""

    name: str
    blocked_flows: frozenset[str] = frozenset()
    required_flows: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True, kw_only=True)
class PolicySettings:
    """What a policy is built from; `revision` goes into every verdict.

    Durations are in ns, `threshold` in metres per frame, `max_vel_limit` and `lowest` in m/s.
    """

    policy: PolicyName
    kind: StreamKind
    flows: tuple[Flow, ...]
    release_after: int = SECOND // 2
    max_age: int = SECOND // 2
    max_hold: int = 600 * SECOND
    queue_size: int = 100
    threshold: float | None = None
    max_vel_limit: float | None = None
    lowest: float = 0.0
    rules: tuple[StageRule, ...] = ()
    revision: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage:
    """One coordination node's part in a stream; `id` is also the last part of its node name."""

    id: str
    coordination_kind: CoordinationKind
    settings: PolicySettings


@dataclass(frozen=True, slots=True, kw_only=True)
class Stream:
    """One topic's flows, the stages they go through in order, and the successors behind them."""

    topic: str
    type: str
    mode: Mode
    flows: tuple[Flow, ...]
    stages: tuple[Stage, ...]
    successors: tuple[str, ...]
    queue_size: int = 100
    done: str | None = None
    block_unapproved: bool = True
    stop: StopProfile = StopProfile()  # noqa: RUF009 - frozen

    @property
    def action(self) -> str:
        """The action whose goals these are, all of which moves together; or nothing."""
        return action_name(self.topic, self.type)

    @property
    def is_ros2_action(self) -> bool:
        """Whether these are an action's goals in ROS 2, which are requests and no topic."""
        return self.action == self.topic

"""Roll-outs as the HTTP API has them. Times are wall clock, ns; durations are seconds."""

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, Field, model_validator

from rtron.service.domain.rollouts.amounts import ALL, Amount, AmountField
from rtron.service.domain.schemas import Name, RequestModel, RequiredReason, SettingsOutcome
from rtron.vocabulary import StringEnum
from rtron.wire.common.link_protocol import MAX_PLAN_LENGTH


class RolloutState(StringEnum):
    """What a roll-out is at; the last three are its ends.

    A roll-out that is done still reaches the robots that were off.
    """

    RUNNING = "running"
    PAUSED = "paused"
    REVERTING = "reverting"
    DONE = "done"
    REVERTED = "reverted"
    CANCELLED = "cancelled"


ACTIVE_STATES = frozenset({RolloutState.RUNNING, RolloutState.PAUSED, RolloutState.REVERTING})
"""No other roll-out may have a robot of one that is at this."""


class RobotPhase(StringEnum):
    """What a robot of a roll-out is at.

    `sending`: what was in force before is stored, so that the change may be made; `sent`: it is a
    revision of the robot's settings; `reverted`: the settings before are a revision again; `stuck`:
    they make no plan any more, so somebody has to look.
    """

    WAITING = "waiting"
    SENDING = "sending"
    SENT = "sent"
    REVERTED = "reverted"
    STUCK = "stuck"


class Problem(StringEnum):
    """What a robot may show after a change that it did not show before.

    `refused`: the guard, or the service, does not take the change. `alarm`: a new alarm. `blocked`:
    a higher share of its messages is blocked. `stopped`: it was stopped. `restarted`: its guard
    began anew. `gone`: its guard is not connected any more, or does not answer.
    """

    REFUSED = "refused"
    ALARM = "alarm"
    BLOCKED = "blocked"
    STOPPED = "stopped"
    RESTARTED = "restarted"
    GONE = "gone"


MAX_STAGES = 20
MAX_ROBOTS = 10_000
_DAY = 86_400.0
DEFAULT_STAGES = (Amount(1), Amount(1000, is_share=True), ALL)
_DEFAULT_LIMITS = {problem: Amount(0) for problem in Problem} | {
    Problem.GONE: Amount(500, is_share=True)
}


def _check_stages(stages: tuple[Amount, ...]) -> tuple[Amount, ...]:
    if any(each.number == 0 for each in stages):
        raise ValueError("a stage has at least one robot")
    if not stages[-1].is_all:
        raise ValueError('the last stage is "100%"')
    return stages


def _with_defaults(limits: Mapping[Problem, Amount]) -> Mapping[Problem, Amount]:
    return {**_DEFAULT_LIMITS, **limits}


class RolloutPolicy(RequestModel):
    """How a change goes out: to how many robots in all by each stage, and when it goes back.

    After the last robot of a stage got the change, `wait` seconds pass before the next stage. The
    change goes back when more robots show a problem than its limit, which may be a share of those
    reached so far. A robot is `blocked` when the share of blocked messages rises by more than
    `blocked_rise`, and `gone` after `answer_within` seconds without its guard or its answer.
    """

    stages: Annotated[
        tuple[AmountField, ...],
        Field(min_length=1, max_length=MAX_STAGES),
        AfterValidator(_check_stages),
    ] = DEFAULT_STAGES
    wait: float = Field(default=300.0, ge=0, le=30 * _DAY)
    limits: Annotated[dict[Problem, AmountField], AfterValidator(_with_defaults)] = Field(
        default_factory=lambda: dict(_DEFAULT_LIMITS)
    )
    blocked_rise: float = Field(default=0.1, ge=0, le=1)
    answer_within: float = Field(default=30.0, gt=0, le=_DAY)


class RobotSelection(RequestModel):
    """Robots by name, or those with a label, of an app, or both."""

    names: list[Name] | None = Field(default=None, min_length=1, max_length=MAX_ROBOTS)
    label: str | None = Field(default=None, min_length=1, max_length=100)
    app: str | None = Field(default=None, min_length=1, max_length=200)

    @model_validator(mode="after")
    def _require_choice(self) -> "RobotSelection":
        if (self.names is None) == (self.label is None and self.app is None):
            raise ValueError("give names, or a label or an app or both")
        return self


class NewRollout(RolloutPolicy):
    """A change to roll out: `nodes` as in a change of one robot's settings, or another `plan`.

    `plan` is the text of a plan file.
    """

    robots: RobotSelection
    nodes: dict[str, dict[str, Any]] = Field(default_factory=dict)
    plan: str | None = Field(default=None, min_length=1, max_length=MAX_PLAN_LENGTH)
    reason: RequiredReason

    @model_validator(mode="after")
    def _require_change(self) -> "NewRollout":
        if bool(self.nodes) == (self.plan is not None):
            raise ValueError("give nodes, or a plan")
        return self

    @property
    def policy(self) -> RolloutPolicy:
        """How it goes out."""
        return RolloutPolicy(**{name: getattr(self, name) for name in RolloutPolicy.model_fields})


class RolloutRequest(RequestModel):
    """A pause, or the end of one; why."""

    reason: RequiredReason


class RolloutCancellation(RolloutRequest):
    """The end of a roll-out; robots that have the change keep it with `keep`."""

    keep: bool = False


class RolloutSummary(BaseModel):
    """A roll-out in the list; `stage` counts from 0, `note` says why it is at its state.

    `sent` robots have the change, `waiting` ones have not got it yet, `reverted` ones have lost it;
    of `stuck` ones it could not be taken back.
    """

    id: int
    by: str
    reason: str
    created: int
    changed: int
    state: RolloutState
    note: str
    stage: int
    total: int
    waiting: int
    sent: int
    reverted: int
    stuck: int


class RolloutView(RolloutSummary):
    """A roll-out in full; `problems` counts the robots that show each.

    `targets` is how many robots in all have the change after each stage; `applied` of them have it
    in force. `plan` is the digest of the plan that goes out, None where settings do.
    """

    nodes: dict[str, dict[str, Any]]
    plan: str | None
    policy: RolloutPolicy
    targets: list[int]
    problems: dict[Problem, int]
    applied: int


class RolloutPage(BaseModel):
    """Roll-outs, newest first; `next` continues with older ones (`before`), None at the end."""

    rollouts: list[RolloutSummary]
    next: int | None


class RolloutRobot(BaseModel):
    """A robot of a roll-out, in the order of getting the change; `outcome` is its guard's."""

    robot: str
    position: int
    phase: RobotPhase
    revision: int | None
    outcome: SettingsOutcome | None
    sent_at: int | None
    problems: list[Problem]
    note: str


class RolloutRobotPage(BaseModel):
    """Robots in order; `next` continues after a position (`after`), None at the end."""

    robots: list[RolloutRobot]
    next: int | None

"""Settings: what people change in a plan while the guard runs (paper section 5.3 and 6.3).

They hold what differs from the plan, nothing else: what is None, or is not named, is as the plan
says. Durations are in ns, `threshold` in metres per frame, `max_vel_limit` in m/s. Each change
makes new settings with the next revision.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from rtron.vocabulary.enums import PolicyName


@dataclass(frozen=True, slots=True, kw_only=True)
class FlowSettings:
    """What differs for one flow: of a GRCN, a vflow or an aflow."""

    priority: int | None = None
    block: bool | None = None
    timeout: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RuleSettings:
    """What differs for one rule of the MSRCN: whether it counts, and its block bits.

    `block` are the aflows, or topics, whose bit is 1; `when` is the condition over the eflows.
    A rule that the plan does not have needs both: it is the end user's own.
    """

    selected: bool | None = None
    block: tuple[str, ...] | None = None
    when: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeSettings:
    """What differs for one coordination node; flows and rules by their names."""

    policy: PolicyName | None = None
    release_after: int | None = None
    max_age: int | None = None
    max_hold: int | None = None
    threshold: float | None = None
    max_vel_limit: float | None = None
    flows: Mapping[str, FlowSettings] = field(default_factory=dict)
    rules: Mapping[str, RuleSettings] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class TimedOverride:
    """What a coordination node forbids passes until `until` (ns); who said so, why.

    By the wall clock in the service, on the robot by the machine's time since its start.
    """

    by: str
    reason: str
    until: int


@dataclass(frozen=True, slots=True, kw_only=True)
class EmergencyStop:
    """Nothing that moves the robot passes until this is taken back; `at` is wall clock, ns."""

    by: str
    reason: str
    at: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """All that differs from the plan, by the id of the coordination node; `revision` counts up.

    `plan` is the SHA-256 of the plan document that a roll-out has put in the place of the one the
    guard was started with; "" is that one.
    """

    revision: int = 0
    nodes: Mapping[str, NodeSettings] = field(default_factory=dict)
    overrides: Mapping[str, TimedOverride] = field(default_factory=dict)
    stop: EmergencyStop | None = None
    plan: str = ""

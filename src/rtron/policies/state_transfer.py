"""What one policy hands to the one that takes its place, so that nothing is lost or forgotten."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from rtron.policies.queues.held_messages import HeldMessage
from rtron.vocabulary import Velocity


@dataclass(frozen=True, slots=True)
class LeaseState:
    """The flow whose turn it is, since when, and when it last made use of it (ns)."""

    flow: str
    granted_at: int
    renewed_at: int


@dataclass(frozen=True, slots=True)
class VelocityRequest:
    """The velocity that was asked for last, what of it went on, and the message it came in."""

    flow: str
    requested: Velocity
    sent: Velocity
    message: bytes = b""


@dataclass(frozen=True, slots=True, kw_only=True)
class PolicyState:
    """The state of a policy at one moment.

    `last_message_times` are the fresh flows, and when the last message of each came (ns).
    `held_messages` are in queue order. `has_lease`: the policy knows which flow, if any, has the
    output. `last_output` is the flow and the message that went out last, behind all stages.
    `last_sent` is the velocity that went out last, also in a stop, and when (ns). `neutral_grant`
    is the number of the grant of a lease whose holder has been neutral.
    """

    last_message_times: Mapping[str, int] = field(default_factory=dict)
    has_lease: bool = False
    lease: LeaseState | None = None
    held_messages: tuple[HeldMessage, ...] = ()
    velocity_request: VelocityRequest | None = None
    last_output: tuple[str, bytes] | None = None
    last_sent: tuple[Velocity, int] | None = None
    neutral_grant: int | None = None

"""What one policy hands to the one that takes its place, so that nothing is lost or forgotten."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from rtron.policies.queues.held_messages import Held
from rtron.vocabulary import Velocity


@dataclass(frozen=True, slots=True)
class InTurn:
    """The flow whose turn it is, since when, and when it last made use of it (ns)."""

    flow: str
    began: int
    renewed: int


@dataclass(frozen=True, slots=True)
class Asked:
    """The velocity that was asked for last, what of it went on, and the message it came in."""

    flow: str
    wanted: Velocity
    sent: Velocity
    message: bytes = b""


@dataclass(frozen=True, slots=True, kw_only=True)
class Carried:
    """The state of a policy at one moment.

    `spoke` are the flows that are fresh, and when each spoke last (ns). `held` are the messages
    that wait, in the order in which their places were taken. `turns`: the policy knows whose turn
    it is, if anybody's. `last` is the flow and the message that went out last, behind all stages.
    """

    spoke: Mapping[str, int] = field(default_factory=dict)
    turns: bool = False
    turn: InTurn | None = None
    held: tuple[Held, ...] = ()
    asked: Asked | None = None
    last: tuple[str, bytes] | None = None

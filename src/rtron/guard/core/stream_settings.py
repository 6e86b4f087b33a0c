"""Other settings of a guarded stream: all is made first, and only then put in force."""

from collections.abc import Mapping
from dataclasses import dataclass

from rtron.errors import PlanError
from rtron.guard.core.observations import Senses
from rtron.guard.core.override_policy import Overridable
from rtron.guard.derived import written_for
from rtron.guard.stages import changed_policies
from rtron.guard.transport.common.protocol import TypeInfo
from rtron.messages.common.velocity import VelocityCodec
from rtron.policies import Policy
from rtron.policies.mission.rule_status import Standing
from rtron.vocabulary import Stream


@dataclass(frozen=True, slots=True)
class Adaptation:
    """Other settings of a stream, ready to be put in force.

    `policies` are those that change, by the coordination node; `md5sum` is that of the messages
    which rules look into, "" where any will do.
    """

    stream: Stream
    policies: Mapping[str, Policy]
    md5sum: str


@dataclass(frozen=True, slots=True)
class Learned:
    """What a stream's publishers have told of their messages, as far as they have."""

    info: TypeInfo | None
    codec: VelocityCodec | None


def adaptation(
    before: Stream,
    after: Stream,
    senses: Senses,
    standings: Mapping[str, Standing],
    learned: Learned,
) -> Adaptation:
    """Return what puts a stream's other settings in force; PlanError if that cannot be."""
    md5sum = written_for(after, senses)
    if learned.info and md5sum not in ("", learned.info.md5sum):
        told = f"{after.topic}: its messages are of another version than the rules look into"
        raise PlanError(told)
    policies = changed_policies(before, after, senses, standings)
    for policy in policies.values():
        if learned.codec and isinstance(policy, Overridable):
            policy.learn(learned.codec)
    return Adaptation(after, policies, md5sum)

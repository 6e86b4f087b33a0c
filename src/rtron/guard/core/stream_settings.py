"""Other settings of a guarded stream: all is made first, and only then put in force."""

from collections.abc import Mapping
from dataclasses import dataclass

from rtron.errors import PlanError
from rtron.guard.core.observations import Observations
from rtron.guard.core.override_policy import OverridablePolicy
from rtron.guard.derived import rules_md5sum
from rtron.guard.stages import changed_policies
from rtron.guard.transport.common.protocol import TypeInfo
from rtron.messages.common.velocity import VelocityCodec
from rtron.policies import Policy
from rtron.policies.mission.rule_status import RuleStatus
from rtron.vocabulary import Stream


@dataclass(frozen=True, slots=True)
class StreamUpdate:
    """Other settings of a stream, ready to be put in force.

    `policies` are those that change, by the coordination node; `md5sum` is that of the messages
    which rules look into, "" where any will do.
    """

    stream: Stream
    policies: Mapping[str, Policy]
    md5sum: str


@dataclass(frozen=True, slots=True)
class MessageFormat:
    """What a stream's publishers have told of their messages, as far as they have."""

    info: TypeInfo | None
    codec: VelocityCodec | None


def prepare_update(
    before: Stream,
    after: Stream,
    observations: Observations,
    rule_statuses: Mapping[str, RuleStatus],
    format: MessageFormat,
) -> StreamUpdate:
    """Return what puts a stream's other settings in force; PlanError if that cannot be."""
    md5sum = rules_md5sum(after, observations)
    if format.info and md5sum not in ("", format.info.md5sum):
        text = f"{after.topic}: its messages are of another version than the rules look into"
        raise PlanError(text)
    policies = changed_policies(before, after, observations, rule_statuses)
    for policy in policies.values():
        if format.codec and isinstance(policy, OverridablePolicy):
            policy.learn(format.codec)
    return StreamUpdate(after, policies, md5sum)

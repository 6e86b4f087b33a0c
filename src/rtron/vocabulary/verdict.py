"""A Verdict: what a policy decides about one message, and why."""

from dataclasses import dataclass

from rtron.vocabulary.enums import Decision, PolicyName


@dataclass(frozen=True, slots=True)
class Verdict:
    """The answer to one message of one flow, with the policy, reason and settings revision."""

    decision: Decision
    flow: str
    policy: PolicyName
    reason: str
    revision: int

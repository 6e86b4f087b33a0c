"""A Verdict: what a policy decides about one message, and why."""

from dataclasses import dataclass

from rtron.vocabulary.enums import Decision, PolicyName


@dataclass(frozen=True, slots=True)
class Verdict:
    """The answer to one message of one flow, with the policy, reason and settings revision.

    `message` is what goes on in its place (modify). `error`: the message could not be judged.
    """

    decision: Decision
    flow: str
    policy: PolicyName
    reason: str
    revision: int
    message: object = None
    error: bool = False

"""A Proposal: a value of a plan and what a measured run says about it."""

from dataclasses import dataclass

from rtron.vocabulary.enums import StringEnum

PROPOSALS_SCHEMA = "rtron.proposals/1"


class TuningProposalKind(StringEnum):
    """What follows from the figures.

    `change`: another value. `keep`: the value fits, or too little was seen to say more. `look`:
    something that no value mends, for a person to look at.
    """

    CHANGE = "change"
    KEEP = "keep"
    LOOK = "look"


@dataclass(frozen=True, slots=True, kw_only=True)
class TuningProposal:
    """What to do with one value of a plan, and the figures behind it.

    `node` is the id of the coordination node, `flow` the flow where it is one's, `key` the key in
    the plan. `before` and `after` are values as the plan writes them, `samples` counts what was
    measured for it.
    """

    kind: TuningProposalKind
    node: str
    key: str
    why: str
    flow: str = ""
    before: str = ""
    after: str = ""
    samples: int = 0

"""A plan for a base that nobody of its launch commands: its topic has no flow yet."""

from rtron.vocabulary import (
    GRCN,
    SECOND,
    Domain,
    Mode,
    Plan,
    PolicyName,
    Sharing,
    StreamKind,
    Supervision,
)

TOPIC, OUT, NODE = "/cmd_vel", "/rtron/cmd_vel/out", "/rtron/closed"
REFUSED = "unapproved publisher /stranger under the public name"


def closed(ros, type):
    """Return the plan: whom it does not name is kept out, and it names nobody."""
    grcn = GRCN(
        id="closed",
        topic=TOPIC,
        type=type,
        domain=Domain.CONTROL,
        kind=StreamKind.COMMAND,
        sharing=Sharing.CONTEND,
        mode=Mode.ENFORCE,
        policy=PolicyName.PREEMPTION,
        flows=(),
        successors=("/base",),
    )
    waits = Supervision(stall_after=SECOND // 5)
    return Plan(app="base", ros=ros, revision=1, grcn=(grcn,), supervision=waits)

"""The coordination nodes that are measured."""

from collections.abc import Sequence

from rtron.vocabulary import GRCN, Domain, Flow, Mode, PolicyName, Sharing, StreamKind

SUBSCRIBER = "/bench_sub"
TWIST = "geometry_msgs/Twist"


def grcn(topic: str, publishers: Sequence[str], type: str = TWIST) -> GRCN:
    """Return an enforcing GRCN under Preemption; the first publisher has the highest priority.

    What is no Twist moves nothing, so the process of large data carries it.
    """
    return GRCN(
        id=f"grcn{topic.replace('/', '_')}",
        topic=topic,
        type=type,
        domain=Domain.CONTROL,
        kind=StreamKind.COMMAND if type.endswith("/Twist") else StreamKind.STATE,
        sharing=Sharing.CONTEND,
        mode=Mode.ENFORCE,
        policy=PolicyName.PREEMPTION,
        flows=flows(publishers),
        successors=(SUBSCRIBER,),
    )


def flows(publishers: Sequence[str]) -> tuple[Flow, ...]:
    """Return one flow a publisher, highest priority first."""
    number = len(publishers)
    return tuple(
        Flow(name=f"flow{index + 1}", publisher=publisher, priority=number - index)
        for index, publisher in enumerate(publishers)
    )

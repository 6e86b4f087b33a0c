"""The process that hosts ten coordination nodes on one stream: `python -m bench.ten`."""

from bench.plans import grcn
from bench.way import PUBLISHER
from rtron.guard.run import run_streams
from rtron.vocabulary import CoordinationKind, Mode, PolicySettings, Stage, Stream
from rtron.wire.address import master_uri

STAGES = 10


def ten_stages() -> Stream:
    """Return a stream that ten GRCNs govern, each with a policy of its own."""
    node = grcn("/cmd_vel", [PUBLISHER])
    settings = PolicySettings(policy=node.policy, kind=node.kind, flows=node.flows)
    stages = tuple(
        Stage(id=f"grcn_{number}", coordination=CoordinationKind.GRCN, settings=settings)
        for number in range(1, STAGES + 1)
    )
    return Stream(
        topic=node.topic,
        type=node.type,
        mode=Mode.ENFORCE,
        flows=node.flows,
        stages=stages,
        successors=node.successors,
    )


if __name__ == "__main__":
    run_streams((ten_stages(),), master_uri())

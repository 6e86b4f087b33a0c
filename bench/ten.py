"""The process that hosts ten coordination nodes on one stream: `python -m bench.ten`."""

from bench.common.plans import grcn
from bench.ros1.routes import PUBLISHER
from rtron.guard.core.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.runner import run_coordinator
from rtron.guard.transport.ros1.middleware import Ros1Transport
from rtron.vocabulary import CoordinationKind, Mode, PolicySettings, Stage, Stream
from rtron.wire.ros1.host_address import master_uri

STAGES = 10


def ten_stages() -> Stream:
    """Return a stream that ten GRCNs govern, each with a policy of its own."""
    node = grcn("/cmd_vel", [PUBLISHER])
    settings = PolicySettings(policy=node.policy, kind=node.kind, flows=node.flows)
    stages = tuple(
        Stage(id=f"grcn_{number}", coordination_kind=CoordinationKind.GRCN, settings=settings)
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
    loop = EventLoop()
    transport = Ros1Transport(loop, master_uri())
    run_coordinator(Coordinator(transport, (ten_stages(),)), transport, loop)

"""A guard with no supervisor: `python -m bench.ros1.guard_process PLAN [--audit]`."""

import argparse
from pathlib import Path

from bench.common.plans import grcn
from bench.ros1.routes import PUBLISHER
from rtron.guard.audit.ros1.auditor import Ros1Auditor
from rtron.guard.core.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.observations import observations_of
from rtron.guard.runner import run_coordinator
from rtron.guard.transport.ros1.middleware import Ros1Transport
from rtron.planning.plan_file.loader import read_plan
from rtron.vocabulary import CoordinationKind, Mode, PolicySettings, Stage, Stream, build_streams
from rtron.wire.ros1.host_address import master_uri


def main() -> None:
    """Guard until stopped."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("plan", type=Path)
    parser.add_argument("--audit", action="store_true", help="with the continuous audit")
    args = parser.parse_args()
    plan, loop = read_plan(args.plan), EventLoop()
    transport = Ros1Transport(loop, master_uri())
    host = Coordinator(transport, build_streams(plan), observations_of(plan))
    auditor = Ros1Auditor(plan, master_uri(), host, transport, loop) if args.audit else None
    run_coordinator(host, transport, loop, auditor)


if __name__ == "__main__":
    main()

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

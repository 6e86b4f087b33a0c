"""A guard with no supervisor: `python -m bench.ros1.guard_process [PLAN] [--audit] [--stages N]`.

It runs a plan, or one stream through N coordination nodes.
"""

import argparse
from pathlib import Path

from bench.common.plans import grcn
from bench.common.pubsub import PUBLISHER
from bench.common.unsupervised_guard import run_coordinator
from rtron.guard.audit.common.alarm_response import AlarmResponse
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.observations import observations_of
from rtron.guard.middleware import Ros1Middleware
from rtron.guard.transport.ros1.middleware import Ros1Transport
from rtron.planning.plan_file.loader import read_plan
from rtron.vocabulary import CoordinationKind, Mode, PolicySettings, Stage, Stream, build_streams
from rtron.wire.ros1.network import master_uri


def main() -> None:
    """Guard until stopped."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("plan", type=Path, nargs="?")
    parser.add_argument("--audit", action="store_true", help="with the continuous audit")
    parser.add_argument("--stages", type=int, metavar="N", help="coordination nodes of a stream")
    args = parser.parse_args()
    loop = EventLoop()
    transport = Ros1Transport(loop, master_uri())
    if args.stages:
        run_coordinator(Coordinator(transport, (_staged(args.stages),)), transport, loop)
        return
    plan = read_plan(args.plan)
    coordinator = Coordinator(transport, build_streams(plan), observations_of(plan))
    response = AlarmResponse(coordinator, transport, plan.audit.on_foreign, dry_run=False)
    middleware = Ros1Middleware(plan, transport, loop)
    audit = (middleware.create_listener(response), middleware.create_auditor(response, None))
    run_coordinator(coordinator, transport, loop, *(audit if args.audit else ()))


def _staged(count: int) -> Stream:
    """Return a stream through `count` GRCNs, each with a policy of its own."""
    node = grcn("/cmd_vel", [PUBLISHER])
    settings = PolicySettings(policy=node.policy, kind=node.kind, flows=node.flows)
    stages = tuple(
        Stage(id=f"grcn_{number}", coordination_kind=CoordinationKind.GRCN, settings=settings)
        for number in range(1, count + 1)
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
    main()

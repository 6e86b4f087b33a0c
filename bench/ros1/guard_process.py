"""A guard with no supervisor, with its audit or without: `python -m bench.ros1.guard_process PLAN [--audit]`."""

import argparse
from pathlib import Path

from rtron.guard.audit.ros1.auditor import Ros1Auditor
from rtron.guard.core.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.observations import observations_of
from rtron.guard.runner import run_coordinator
from rtron.guard.transport.ros1.middleware import Ros1Transport
from rtron.planning.plan_file.loader import read_plan
from rtron.vocabulary import build_streams
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

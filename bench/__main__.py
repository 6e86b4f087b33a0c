"""`python -m bench [PART ...]`: measure all parts, or those that are named."""

import argparse
import sys
from collections.abc import Iterator, Sequence
from importlib.util import find_spec
from pathlib import Path
from pkgutil import resolve_name

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from bench.common.testbed import ROOT, Part, Testbed, open_testbed
from figures.figure import Figure
from figures.table import number, table, write

PARTS = {
    "command_line": "common.command_line:figures",
    "policies": "common.policies:figures",
    "rules": "common.rules:figures",
    "violations": "common.violations:figures",
    "replay": "common.replay:figures",
    "discovery": "common.discovery:figures",
    "hop": "ros1.hop:figures",
    "chain": "ros1.hop:chain_figures",
    "load": "ros1.load:figures",
    "silence": "ros1.silence:figures",
    "incidents": "ros1.hop:incident_figures",
    "supervisor": "ros1.supervisor:figures",
    "memory": "ros1.memory:figures",
    "actions": "ros1.actions:figures",
    "audit": "ros1.audit:figures",
    "audit_cost": "ros1.audit_cost:figures",
    "intrusion": "ros1.intrusion:figures",
    "churn": "ros1.churn:figures",
    "cell": "cell.figures_ros1:figures",
    "prevention": "cell.prevention_ros1:figures",
    "bridge": "bridge.latency:figures",
    "ingest": "service.ingest:figures",
    "link": "service.link:figures",
    "faults": "service.faults:figures",
    "fleet": "service.fleet:figures",
    "console": "service.console_fleet:figures",
    "replicas": "service.replicas:figures",
    "rollouts": "service.rollouts:figures",
}
ROS2_PARTS = {
    "ros2_discovery": "ros2.discovery:figures",
    "ros2_hop": "ros2.hop:figures",
    "ros2_audit": "ros2.audit:figures",
    "ros2_intrusion": "ros2.intrusion:figures",
    "ros2_security": "ros2.security:figures",
    "ros2_prevention": "ros2.prevention:figures",
    "ros2_cell": "cell.figures_ros2:figures",
}
"""Need rclpy: these run where it is installed, the others where it is not."""
ZENOH_PARTS = {"zenoh": "zenoh.access:figures"} if find_spec("zenoh") else {}
AVAILABLE_PARTS = ROS2_PARTS if find_spec("rclpy") else PARTS | ZENOH_PARTS
OUTPUT = ROOT / "build" / "bench.json"


def main() -> None:
    """Measure, write the JSON, print the table."""
    args = _arguments()
    chosen, output = args.parts, args.output
    console = Console(width=None if sys.stdout.isatty() else 110)
    found: list[Figure] = []
    with open_testbed() as testbed, _progress(console) as progress:
        for figure in _measure(testbed, chosen or list(AVAILABLE_PARTS), progress):
            found.append(figure)
            console.print(f"{figure.name}: {number(figure.ours)} {figure.unit}")
            write(found, output, keep=bool(chosen))
    console.print(table("Less is better, unless >= is wanted", found))
    console.print(f"written to {output}")


def _measure(testbed: Testbed, names: Sequence[str], progress: Progress) -> Iterator[Figure]:
    task = progress.add_task("", total=len(names))
    for name in names:

        def report(what: str, name: str = name) -> None:
            progress.update(task, description=f"{name}: {what}")

        yield from _part(name)(testbed, report)
        progress.advance(task)


def _part(name: str) -> Part:
    """Return a part; only its own imports are needed."""
    part: Part = resolve_name(f"bench.{AVAILABLE_PARTS[name]}")
    return part


def _progress(console: Console) -> Progress:
    description = TextColumn("{task.description}")
    return Progress(
        description, BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), console=console
    )


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m bench", description=__doc__)
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(AVAILABLE_PARTS))
    parser.add_argument("-o", "--output", type=Path, default=OUTPUT, help="the JSON file")
    args = parser.parse_args()
    if unknown := set(args.parts) - set(AVAILABLE_PARTS):
        parser.error(f"no such part with this Python: {', '.join(sorted(unknown))}")
    return args


if __name__ == "__main__":
    main()

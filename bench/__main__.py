"""`python -m bench [PART ...]`: measure all parts, or those that are named."""

import argparse
import sys
from collections.abc import Iterator, Sequence
from importlib.util import find_spec
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from bench.common import discovery, policies, replay, rules, violations
from bench.common.testbed import ROOT, Part, Testbed, open_testbed
from bench.ros1 import (
    actions,
    audit,
    audit_cost,
    churn,
    hop,
    intrusion,
    load,
    memory,
    silence,
    supervisor,
)
from bench.ros2 import audit as ros2_audit
from bench.ros2 import discovery as ros2_discovery
from bench.ros2 import hop as ros2_hop
from bench.ros2 import intrusion as ros2_intrusion
from bench.service import faults, ingest, link
from figures.figure import Figure
from figures.table import number, table, write

PARTS: dict[str, Part] = {
    "policies": policies.figures,
    "rules": rules.figures,
    "violations": violations.figures,
    "replay": replay.figures,
    "discovery": discovery.figures,
    "hop": hop.figures,
    "chain": hop.chain_figures,
    "load": load.figures,
    "silence": silence.figures,
    "supervisor": supervisor.figures,
    "memory": memory.figures,
    "actions": actions.figures,
    "audit": audit.figures,
    "audit_cost": audit_cost.figures,
    "intrusion": intrusion.figures,
    "churn": churn.figures,
    "ingest": ingest.figures,
    "link": link.figures,
    "faults": faults.figures,
}
ROS2_PARTS: dict[str, Part] = {
    "ros2_discovery": ros2_discovery.figures,
    "ros2_hop": ros2_hop.figures,
    "ros2_audit": ros2_audit.figures,
    "ros2_intrusion": ros2_intrusion.figures,
}
"""Need rclpy: these run where it is installed, the others where it is not."""
AVAILABLE_PARTS = ROS2_PARTS if find_spec("rclpy") else PARTS
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

        yield from AVAILABLE_PARTS[name](testbed, report)
        progress.advance(task)


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

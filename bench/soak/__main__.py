"""`python -m bench.soak`: load, kill, freeze and attack a guarded app at random, and judge.

The app has every kind of coordination node. A table compares each figure with its bound: whose
commands came through, how long a moving base heard nothing, whether the speed kept to the frame
rate and the rule blocked, what became of the goals, and how the guard's processes grew. The exit
code is 1 if a figure is over its bound. On ROS 2 with the Python that has rclpy, else on ROS 1.
"""

import argparse
import random
import sys
import time
from collections.abc import Mapping
from dataclasses import asdict
from importlib.util import find_spec
from pathlib import Path

from rich.console import Console

from bench.common.testbed import ROOT, open_testbed
from bench.soak.app import SoakedApp, running_app
from bench.soak.base_log import LONGEST_GAP, BaseLog
from bench.soak.faults import WEIGHTS, RandomFaults
from bench.soak.memory import MemoryWatch
from bench.soak.processor_wait import ProcessorWait
from bench.soak.report import Findings, as_table, write_json

_PAUSE_S = (0.5, 8.0)
_SETTLE_S = 5.0
_MS = 1e6


def main() -> None:
    """Soak, print what happened, and end with 1 if something must not have."""
    args = _arguments()
    ros = 2 if find_spec("rclpy") else 1
    console = Console(width=None if sys.stdout.isatty() else 110)
    title = f"ROS {ros}, {args.seconds} s, --seed {args.seed}"
    console.print(title)
    with open_testbed() as testbed, running_app(testbed, ros, args.stall_after) as app:
        faults, memory = RandomFaults(app, args.seed, args.only), MemoryWatch(app)
        wait = ProcessorWait(app)
        _soak(app, faults, memory, args.seconds, console)
        wait.close()
        findings = Findings(app, faults, memory, wait)
        _keep(args.output, {"log": testbed.folder / "errors.log", **app.files})
    rows = list(findings.rows())
    done = [asdict(each) for each in faults.history]
    write_json(args.output, rows, ros=ros, seed=args.seed, seconds=args.seconds, faults=done)
    console.print(as_table(rows, title))
    _explain(findings, faults, console)
    over = [row for row in rows if row.is_over]
    for row in over:
        console.print(f"[red]over[/]: {row.name}")
    console.print(f"written to {args.output}, log and data beside it")
    sys.exit(1 if over else 0)


def _keep(output: Path, files: Mapping[str, Path]) -> None:
    """Copy what the processes wrote to files beside the result."""
    output.parent.mkdir(parents=True, exist_ok=True)
    for name, file in files.items():
        output.with_name(f"{output.stem}-{name}.txt").write_bytes(file.read_bytes())


def _soak(
    app: SoakedApp, faults: RandomFaults, memory: MemoryWatch, seconds: int, console: Console
) -> None:
    """Act for a while, and print each act beside what the base has heard until then."""
    faults.wait_for_app()
    begin = time.monotonic()
    while (passed := time.monotonic() - begin) < seconds:
        done = faults.act(_PAUSE_S)
        memory.sample()
        base = BaseLog.read(app.files["base"])
        gaps = len(base.unexplained_gaps())
        console.print(
            f"{passed:5.0f} s of {seconds}: {done}; {len(base.outputs)} commands, {gaps} gaps"
        )
    time.sleep(_SETTLE_S)


def _explain(findings: Findings, faults: RandomFaults, console: Console) -> None:
    """Tell for each gap and each command over the limit what was done last, before it or in it."""
    for gap in findings.base.unexplained_gaps():
        console.print(f"a gap of {gap.length / _MS:.0f} ms: {_last_faults(faults, gap.at)}")
        waited = findings.wait.within(gap) / _MS
        console.print(
            f"  {findings.base.describe(gap)}; guard and supervisor waited {waited:.0f} ms to run"
        )
    for role in findings.ended:
        console.print(f"{role} has ended by itself")
    for command in findings.too_fast[:10]:
        console.print(f"{command.speed:.3g} m/s too fast: {_last_faults(faults, command.at)}")


def _last_faults(faults: RandomFaults, at: int) -> str:
    done = [
        f"{each.name} {(each.span.at - at) / 1e9:+.2f} s"
        for each in faults.history
        if each.span.at < at + LONGEST_GAP
    ]
    return ", ".join(done[-2:]) or "nothing"


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m bench.soak", description=__doc__)
    parser.add_argument("--seconds", type=int, default=900, help="how long (900)")
    seed = random.SystemRandom().randrange(1 << 31)
    parser.add_argument("--seed", type=int, default=seed, help="repeats what was done")
    help_only = "do nothing else, e.g. 'guard frozen'; again for more"
    parser.add_argument(
        "--only", action="append", default=[], choices=WEIGHTS, metavar="WHAT", help=help_only
    )
    help_stall = "of the supervisor, e.g. '55 ms'; without it the default"
    parser.add_argument("--stall-after", default="", metavar="TIME", help=help_stall)
    default = ROOT / "build" / "soak.json"
    parser.add_argument("-o", "--output", type=Path, default=default, help="the JSON file")
    return parser.parse_args()


if __name__ == "__main__":
    main()

"""`python -m bench.soak`: load, kill, freeze and attack a guarded app at random, and judge.

No command of who is not in the plan may come through, a base that moves may not wait over 100 ms
for its next command unless the navigation was silent, and no process of the guard may grow. The
exit code is 1 if any of that is not so. On ROS 2 with the Python that has rclpy, else on ROS 1.
"""

import argparse
import random
import sys
import time
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

from rich.console import Console
from rich.progress import Progress

from bench.common.testbed import ROOT, open_testbed
from bench.soak.actions import RandomActions
from bench.soak.app import SoakedApp, running_app
from bench.soak.base_log import BaseLog
from bench.soak.memory import MemoryWatch
from bench.soak.node import INTRUDING, SPEED
from figures.figure import Figure
from figures.table import table, write

_PAUSE_S = (0.5, 8.0)
_MAX_GROWTH_MB = 10.0
_MS = 1e6


def main() -> None:
    """Soak, print what happened, and end with 1 if something must not have."""
    args = _arguments()
    ros = 2 if find_spec("rclpy") else 1
    console = Console(width=None if sys.stdout.isatty() else 110)
    console.print(f"ROS {ros}, {args.seconds} s, --seed {args.seed}")
    with open_testbed() as testbed, running_app(testbed, ros) as app:
        actions, memory = RandomActions(app, args.seed), MemoryWatch(app)
        history = _soak(app, actions, memory, args.seconds, console)
        base = BaseLog.read(app.told)
        (args.output.parent).mkdir(parents=True, exist_ok=True)
        log = args.output.with_suffix(".log")
        log.write_bytes((testbed.folder / "errors.log").read_bytes())
        pictures = app.picture_count()
    found = [*_figures(base, memory), *_counts(actions)]
    found.append(Figure("soak.pictures", pictures, None, "of 10 MB through the guard"))
    write(found, args.output, keep=False)
    console.print(table("Less is better", found))
    _explain(base, history, console)
    console.print(f"written to {args.output}, the log to {log}")
    sys.exit(1 if any(figure.met is False for figure in found) else 0)


def _soak(
    app: SoakedApp, actions: RandomActions, memory: MemoryWatch, seconds: int, console: Console
) -> list[tuple[int, str]]:
    """Act for a while; return what was done when, ns of the steady clock."""
    history: list[tuple[int, str]] = []
    pauses = random.Random(actions.seed)
    begin = time.monotonic()
    with Progress(console=console) as progress:
        task = progress.add_task("the app starts", total=seconds)
        while (passed := time.monotonic() - begin) < seconds:
            time.sleep(pauses.uniform(*_PAUSE_S))
            memory.sample()
            now = time.monotonic_ns()
            history.append((now, actions.act()))
            commands = len(BaseLog.read(app.told).outputs)
            progress.update(task, completed=passed, description=f"{commands} commands")
    return history


def _figures(base: BaseLog, memory: MemoryWatch) -> Iterator[Figure]:
    yield Figure("soak.commands", len(base.outputs), None, "at the base", at_least=1)
    yield Figure("soak.unguarded", len(base.unguarded()), None, "commands", at_most=0)
    gaps = len(base.unexplained_gaps())
    yield Figure("soak.gaps", gaps, None, "over 100 ms while moving", at_most=0)
    stalled = sum(each.length for each in base.stalls) / _MS
    yield Figure("soak.base_stalls", stalled, None, "ms in which the base itself did not run")
    yield Figure("soak.longest_gap", base.longest_gap() / _MS, None, "ms while moving")
    yield Figure("soak.longest_rest", base.longest_rest() / _MS, None, "ms")
    yield Figure("soak.navigation_share", base.share(SPEED), None, "of the time")
    yield Figure("soak.intruder_share", base.share(INTRUDING), None, "of the time")
    for growth in memory.growths():
        unit = f"MB in {growth.seconds:.0f} s"
        name = f"soak.growth.{growth.program}"
        yield Figure(name, growth.megabytes, None, unit, at_most=_MAX_GROWTH_MB)


def _counts(actions: RandomActions) -> Iterator[Figure]:
    for name, count in sorted(actions.done.items()):
        yield Figure(f"soak.times.{name.replace(' ', '_')}", count, None, "times")
    yield Figure("soak.refused_clears", actions.refused_clears, None, "times")


def _explain(base: BaseLog, history: list[tuple[int, str]], console: Console) -> None:
    """Tell for each gap what was done last, before it or in it."""
    for gap in base.unexplained_gaps():
        done = [
            f"{what} {(at - gap.at) / 1e9:+.2f} s"
            for at, what in history
            if at < gap.at + gap.length
        ]
        console.print(f"a gap of {gap.length / _MS:.0f} ms: {', '.join(done[-2:]) or 'nothing'}")
        console.print(f"  {base.describe(gap)}")


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m bench.soak", description=__doc__)
    parser.add_argument("--seconds", type=int, default=900, help="how long (900)")
    seed = random.SystemRandom().randrange(1 << 31)
    parser.add_argument("--seed", type=int, default=seed, help="repeats what was done")
    default = ROOT / "build" / "soak.json"
    parser.add_argument("-o", "--output", type=Path, default=default, help="the JSON file")
    return parser.parse_args()


if __name__ == "__main__":
    main()

"""The demo: a small ROS 1 app is attacked, guarded and attacked again.

`python -m rtron.demos.ros1` needs Debian's ROS 1 packages; everything it starts ends with it.
"""

import argparse
import os
import shutil
import sys
import tempfile
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table
from rich.text import Text

from rtron.demos.picture import WIDTH, terminal_picture
from rtron.demos.processes import Processes, free_port
from rtron.demos.robot import Drive, Robot
from rtron.errors import RTronError, SourceError

APP = Path(__file__).parent / "ros1_app"
NEEDED = ("rosmaster", "roslaunch")
ATTACKER, NAVIGATOR = "/tb3_safe_control", "/navigator"
_RESULTS = ("graph.json", "risks.json", "rtron.yaml", "guarded.launch", "report.txt", "scan.svg")


@dataclass(frozen=True, slots=True)
class Demo:
    """What the steps share: the screen, the results' folder and the processes."""

    console: Console
    out: Path
    environ: dict[str, str]
    processes: Processes
    robot: Robot

    def say(self, text: str) -> None:
        """Print one line about what happens next."""
        self.console.print(f"[bold cyan]»[/] {text}")

    def show(self, text: str) -> None:
        """Print what a command printed."""
        self.console.print(Text.from_ansi(text), soft_wrap=True)

    def rtron(self, *arguments: str | Path) -> str:
        """Run a command of rtron and return what it prints; SourceError if it fails."""
        shown = " ".join(a.name if isinstance(a, Path) else a for a in arguments)
        self.console.print(Text(f"$ rtron {shown}", style="dim"), soft_wrap=True)
        return self.processes.finish([sys.executable, "-m", "rtron", *arguments], self.environ)


@dataclass(frozen=True, slots=True)
class Row:
    """A line of the final table."""

    title: str
    cell: Callable[[Drive], str]


_ROWS = (
    Row("malicious commands sent", lambda drive: str(drive.right_sent)),
    Row("malicious commands that reached the driver", lambda drive: str(drive.right_arrived)),
    Row("navigation commands sent", lambda drive: str(drive.forward_sent)),
    Row("navigation commands that reached the driver", lambda drive: str(drive.forward_arrived)),
    Row("turned to the right, degrees", lambda drive: str(round(drive.turned_right))),
    Row("came nearer to the goal, metres", lambda drive: f"{drive.x:.2f}"),
)


def run(out: Path) -> int:
    """Run the demo, write its results to `out`, and return the exit code."""
    console = Console(record=True)
    try:
        _check_surroundings()
        out.mkdir(parents=True, exist_ok=True)
        with ExitStack() as stack:
            before, after = _both(stack, console, out)
    except RTronError as error:
        console.print(f"[bold red]error:[/] {error}", soft_wrap=True)
        return 2
    console.print(_table(before, after))
    console.print(f"Written to {out}: {', '.join(_RESULTS)}", soft_wrap=True)
    (out / "report.txt").write_text(console.export_text(clear=False), encoding="utf-8")
    return 0 if before.right_arrived and not after.right_arrived else 1


def _check_surroundings() -> None:
    missing = [name for name in NEEDED if not shutil.which(name)]
    if missing:
        raise SourceError(f"not installed: {', '.join(missing)}; run `make setup`")


def _both(stack: ExitStack, console: Console, out: Path) -> tuple[Drive, Drive]:
    home = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="rtron-demo-")))
    environ = _environ(home)
    processes = stack.enter_context(Processes(home))
    robot = Robot(environ["ROS_MASTER_URI"])
    demo = Demo(console, out, environ, processes, robot)
    demo.say(f"starting a ROS master at {robot.master}")
    processes.start(["rosmaster", "--core", "-p", robot.master.rpartition(":")[2]], environ)
    robot.wait_for_master()
    before = _unguarded(demo)
    _guard(demo)
    return before, _guarded(demo)


def _environ(home: Path) -> dict[str, str]:
    """Return the environment of a ROS of our own."""
    return os.environ | {
        "ROS_MASTER_URI": f"http://127.0.0.1:{free_port()}",
        "ROS_IP": "127.0.0.1",
        "ROS_HOSTNAME": "127.0.0.1",
        "ROS_HOME": str(home),
        "ROS_LOG_DIR": str(home / "log"),
        "ROS_PACKAGE_PATH": str(APP.parent),
        "PYTHONPATH": "",
        "COLUMNS": str(WIDTH),
        "FORCE_COLOR": "1",
    }


def _unguarded(demo: Demo) -> Drive:
    """Scan the running app, attack it, and return what happened."""
    demo.say("starting the app as it is, without a guard")
    with demo.processes.running(["roslaunch", APP / "launch" / "app.launch"], demo.environ):
        demo.robot.wait_until_ready()
        _scan(demo)
        drive = _attack(demo)
    demo.robot.forget()
    return drive


def _scan(demo: Demo) -> None:
    demo.say("who can interfere with whom?")
    graph, risks = demo.out / "graph.json", demo.out / "risks.json"
    never = ("--fail-on", "never")
    demo.rtron("scan", "--live", "--format", "graph", "-o", graph, *never)
    demo.rtron("scan", graph, "--format", "json", "-o", risks, *never)
    text = demo.rtron("scan", "--live", *never)
    demo.show(text)
    picture = terminal_picture(text, "rtron scan --live")
    (demo.out / "scan.svg").write_text(picture, encoding="utf-8")


def _guard(demo: Demo) -> None:
    """Make the plan and the guarded launch."""
    launch, plan = APP / "launch" / "app.launch", demo.out / "rtron.yaml"
    demo.say("what should stand in between?")
    graph = demo.out / "graph.json"
    demo.rtron("plan", graph, "--launch", launch, "-o", plan)
    demo.show(demo.rtron("check", plan, "--graph", graph))
    demo.say("the guarded launch: the app's own launch, plus remaps and the guard")
    guarded = demo.out / "guarded.launch"
    demo.show(demo.rtron("instrument", launch, "--plan", plan, "-o", guarded))


def _guarded(demo: Demo) -> Drive:
    """Attack the guarded app, and return what happened."""
    demo.say("$ roslaunch guarded.launch")
    with demo.processes.running(["roslaunch", demo.out / "guarded.launch"], demo.environ):
        demo.robot.wait_until_ready()
        return _attack(demo)


def _attack(demo: Demo) -> Drive:
    demo.say(f"{NAVIGATOR} drives; then {ATTACKER} floods turn-right commands")
    return demo.robot.drive(before=2.0, under_attack=4.0)


def _table(before: Drive, after: Drive) -> Table:
    table = Table(title="The same attack, without and with the guard")
    table.add_column("")
    for title in ("without", "guarded"):
        table.add_column(title, justify="right")
    for row in _ROWS:
        table.add_row(row.title, row.cell(before), row.cell(after))
    return table


def _main() -> int:
    parser = argparse.ArgumentParser(prog="python -m rtron.demos.ros1", description=__doc__)
    help = "where the results go (default: build/demo)"
    parser.add_argument("--out", type=Path, default=Path("build/demo"), help=help)
    try:
        return run(parser.parse_args().out.resolve())
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    sys.exit(_main())

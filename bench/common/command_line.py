"""What help, a misspelt command and a TAB cost, beside the help of a bare typer program.

In processor time, which is what a person waits for on an idle machine, and the same on a busy one.
"""

import os
import resource
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence

from bench.common.testbed import ReportProgress, Testbed
from figures.figure import Figure

_REPEATS = 15
_AT_MOST_S = 0.3
_RATIO_AT_MOST = 2.0
_BARE = """
import typer
app = typer.Typer(rich_markup_mode=None, add_completion=False)
@app.command()
def main(name: str = typer.Option("", help="A name.")) -> None: ...
app()
"""
_PEER = (sys.executable, "-c", _BARE, "--help")
_RTRON = (sys.executable, "-m", "rtron")
_TAB = {"_RTRON_COMPLETE": "complete_bash", "COMP_WORDS": "rtron sc", "COMP_CWORD": "1"}
_CASES: Mapping[str, tuple[tuple[str, ...], Mapping[str, str]]] = {
    "help": (("--help",), {}),
    "scan_help": (("scan", "--help"), {}),
    "misspelt": (("scna",), {}),
    "tab": ((), _TAB),
}


def figures(_testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give the time of each, s, in turn with the bare program."""
    for name, (words, variables) in _CASES.items():
        progress(name)
        pairs = [
            (_seconds((*_RTRON, *words), variables), _seconds(_PEER, {})) for _ in range(_REPEATS)
        ]
        ours, peer = zip(*pairs, strict=True)
        yield Figure.of_runs(
            f"command_line.{name}",
            ours,
            peer,
            "s (peer: a bare typer program's help)",
            at_most=_AT_MOST_S,
            ratio_at_most=_RATIO_AT_MOST,
        )


def _seconds(command: Sequence[str], variables: Mapping[str, str]) -> float:
    before = _children_seconds()
    subprocess.run(command, env={**os.environ, **variables}, capture_output=True, check=False)
    return _children_seconds() - before


def _children_seconds() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime

"""Starts processes and ends them again, whatever happens; touches no others.

A mark tells what our processes have started themselves, wherever it has gone. Run as a program it
reads marks, a line each, until whoever writes them is gone, and kills what has one of them.
"""

import os
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from signal import SIGINT, SIGKILL, SIGTERM
from types import TracebackType
from uuid import uuid4

from rtron.demos.runtime.signals import defer_signals, interrupt_on_signals
from rtron.errors import SourceError

Environ = Mapping[str, str]
Command = Sequence[str | Path]
_TERMINATION_STEPS = ((SIGINT, 10.0), (SIGTERM, 5.0), (SIGKILL, 10.0))
_COMMAND_LIMIT = 120.0
_SHOWN = 2000
MARK = "RTRON_STARTED_BY"
"""The variable of the environment that holds the mark."""
_LIMIT = 10.0
_PAUSE = 0.02


@dataclass(frozen=True, slots=True)
class StartedProcess:
    """A process of ours, the file that it writes to, and the mark that its descendants inherit."""

    popen: subprocess.Popen[bytes]
    log: Path
    mark: str

    def output(self) -> str:
        """Return what the process has written so far."""
        return self.log.read_text(encoding="utf-8", errors="replace")

    def check(self) -> None:
        """Raise SourceError, with what it said last, if the process has ended."""
        if self.popen.poll() is not None:
            code = f"ended with {self.popen.returncode}"
            raise SourceError(f"{self.log.stem} {code}\n{self.output()[-_SHOWN:]}")


@dataclass(frozen=True, slots=True)
class CompletedCommand:
    """A command that came to its end: as one would type it, its exit code, what it printed."""

    command: str
    code: int
    text: str


class ProcessGroup:
    """The processes that were started here; on leaving, those that still run are ended.

    Each has a session of its own, so that ^C reaches this process only, and this one ends the
    others. SIGTERM and a closed terminal end this process as ^C does; nothing is heard while
    processes are being ended. If this process is killed, a watchdog kills them.
    To be entered in the main thread.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._running: list[StartedProcess] = []
        self._count = 0
        self._signal_handling = interrupt_on_signals()

    def __enter__(self) -> "ProcessGroup":  # noqa: PYI034 - `Self` is not in Python 3.10
        self._signal_handling.__enter__()
        self._watchdog = subprocess.Popen(
            [sys.executable, "-m", "rtron.demos.runtime.processes"],
            cwd=self._folder,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
            stdin=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        try:
            self.end(tuple(self._running))
        finally:
            self._watchdog.communicate()
            self._signal_handling.__exit__(kind, error, trace)

    def start(self, command: Command, environ: Environ, name: str = "") -> StartedProcess:
        """Start a process; what it says goes to a file that is named after it."""
        self._count += 1
        log = self._folder / f"{self._count:02}-{name or Path(command[0]).name}.log"
        mark = uuid4().hex
        print(mark, file=self._watchdog.stdin, flush=True)
        with log.open("wb") as output, defer_signals():
            popen = subprocess.Popen(  # noqa: S603 - the commands are the demo's own
                [str(word) for word in command],
                cwd=self._folder,  # Python imports from where it is: not from the user's folder
                env={**environ, MARK: mark},
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
            started = StartedProcess(popen, log, mark)
            self._running.append(started)
        return started

    @contextmanager
    def running(
        self, command: Command, environ: Environ, name: str = ""
    ) -> Iterator[StartedProcess]:
        """Run a process until the end of the block.

        A SourceError there shows what it said last, if it has ended by itself: that may be why.
        """
        started = self.start(command, environ, name)
        try:
            yield started
        except SourceError as error:
            if started.popen.poll() is None:
                raise
            last = f"{started.log.stem} said last:\n{started.output()[-_SHOWN:]}"
            raise SourceError(f"{error}\n{last}", help=error.help) from error
        finally:
            self.end([started])

    def run_command(
        self, command: Command, environ: Environ, codes: Collection[int] = (0,), name: str = ""
    ) -> CompletedCommand:
        """Run a command to its end; SourceError if it takes too long or ends with another code."""
        command_line = shlex.join(map(str, command))
        with self.running(command, environ, name) as started:
            try:
                code = started.popen.wait(_COMMAND_LIMIT)
            except subprocess.TimeoutExpired:
                raise SourceError(f"{command_line} takes more than {_COMMAND_LIMIT:g} s") from None
            if code not in codes:
                raise SourceError(f"{command_line} failed ({code})")
            return CompletedCommand(command_line, code, started.output())

    def end(self, started_processes: Sequence[StartedProcess]) -> None:
        """End processes together, and with force what they started and left behind."""
        with defer_signals():
            for number, grace in _TERMINATION_STEPS:
                for started in _alive(started_processes):
                    started.popen.send_signal(number)
                _wait(_alive(started_processes), grace)
            _kill_descendants({started.mark for started in started_processes})
            self._running = [other for other in self._running if other not in started_processes]


def _alive(started_processes: Iterable[StartedProcess]) -> list[StartedProcess]:
    return [started for started in started_processes if started.popen.poll() is None]


def _wait(started_processes: Iterable[StartedProcess], limit: float) -> None:
    deadline = time.monotonic() + limit
    for started in started_processes:
        with suppress(subprocess.TimeoutExpired):  # what still runs is killed next
            started.popen.wait(max(0.0, deadline - time.monotonic()))


def _kill_descendants(marks: Collection[str]) -> None:
    """Kill every process that has one of the marks, and wait until they are gone."""
    markers = {f"{MARK}={mark}".encode() for mark in marks}
    deadline = time.monotonic() + _LIMIT
    while _kill_marked(markers) and time.monotonic() < deadline:
        time.sleep(_PAUSE)


def _kill_marked(markers: Collection[bytes]) -> bool:
    """Kill those that are there; tell whether there were any."""
    found = False
    for folder in Path("/proc").glob("[0-9]*"):
        if _has_marker(folder, markers):
            found |= _kill(int(folder.name), markers)
    return found


def _kill(pid: int, markers: Collection[bytes]) -> bool:
    with suppress(ProcessLookupError), _open_pidfd(pid) as handle:
        # A pid may have been given to another process meanwhile; the handle stays with one.
        if _has_marker(Path("/proc", str(pid)), markers):
            signal.pidfd_send_signal(handle, signal.SIGKILL)
            return True
    return False


@contextmanager
def _open_pidfd(pid: int) -> Iterator[int]:
    handle = os.pidfd_open(pid)
    try:
        yield handle
    finally:
        os.close(handle)


def _has_marker(folder: Path, markers: Collection[bytes]) -> bool:
    """Tell whether a process has a mark; one that is gone, or a zombie, has none."""
    try:
        return not set((folder / "environ").read_bytes().split(b"\0")).isdisjoint(markers)
    except OSError:
        return False


if __name__ == "__main__":
    _kill_descendants(sys.stdin.read().split())

"""Starts processes and ends them again, whatever happens; touches no others."""

import shlex
import subprocess
import time
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from signal import SIGINT, SIGKILL, SIGTERM
from types import TracebackType

from rtron.demos.runtime.descendants import MARK, end_kin, new_mark
from rtron.demos.runtime.signals import deferred, heard
from rtron.errors import SourceError

Environ = Mapping[str, str]
Command = Sequence[str | Path]
_GRACES = ((SIGINT, 10.0), (SIGTERM, 5.0), (SIGKILL, 10.0))
_COMMAND_LIMIT = 120.0
_SHOWN = 2000


@dataclass(frozen=True, slots=True)
class Started:
    """A process of ours, the file that it writes to, and the mark that its descendants inherit."""

    popen: subprocess.Popen[bytes]
    log: Path
    mark: str

    def said(self) -> str:
        """Return what the process has written so far."""
        return self.log.read_text(encoding="utf-8", errors="replace")

    def check(self) -> None:
        """Raise SourceError, with what it said last, if the process has ended."""
        if self.popen.poll() is not None:
            code = f"ended with {self.popen.returncode}"
            raise SourceError(f"{self.log.stem} {code}\n{self.said()[-_SHOWN:]}")


@dataclass(frozen=True, slots=True)
class Finished:
    """A command that came to its end: as one would type it, its exit code, what it printed."""

    command: str
    code: int
    text: str


class Processes:
    """The processes that were started here; on leaving, those that still run are ended.

    Each has a session of its own, so that ^C reaches this process only, and this one ends the
    others. SIGTERM and a closed terminal end this process as ^C does; nothing is heard while
    processes are being ended.
    To be entered in the main thread.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._running: list[Started] = []
        self._count = 0
        self._heard = heard()

    def __enter__(self) -> "Processes":  # noqa: PYI034 - `Self` is not in Python 3.10
        self._heard.__enter__()
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
            self._heard.__exit__(kind, error, trace)

    def start(self, command: Command, environ: Environ, name: str = "") -> Started:
        """Start a process; what it says goes to a file that is named after it."""
        self._count += 1
        log = self._folder / f"{self._count:02}-{name or Path(command[0]).name}.log"
        mark = new_mark()
        with log.open("wb") as output, deferred():
            popen = subprocess.Popen(  # noqa: S603 - the commands are the demo's own
                [str(word) for word in command],
                cwd=self._folder,  # Python imports from where it is: not from the user's folder
                env={**environ, MARK: mark},
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
            started = Started(popen, log, mark)
            self._running.append(started)
        return started

    @contextmanager
    def running(self, command: Command, environ: Environ, name: str = "") -> Iterator[Started]:
        """Run a process until the end of the block.

        A SourceError there shows what it said last, if it has ended by itself: that may be why.
        """
        started = self.start(command, environ, name)
        try:
            yield started
        except SourceError as error:
            if started.popen.poll() is None:
                raise
            last = f"{started.log.stem} said last:\n{started.said()[-_SHOWN:]}"
            raise SourceError(f"{error}\n{last}", help=error.help) from error
        finally:
            self.end([started])

    def finish(
        self, command: Command, environ: Environ, codes: Collection[int] = (0,), name: str = ""
    ) -> Finished:
        """Run a command to its end; SourceError if it takes too long or ends with another code."""
        with self.finishing(command, environ, codes, name) as finished:
            return finished()

    @contextmanager
    def finishing(
        self, command: Command, environ: Environ, codes: Collection[int] = (0,), name: str = ""
    ) -> Iterator[Callable[[], Finished]]:
        """Run a command beside the block, which waits for its end as `finish` does, or ends it."""
        typed = shlex.join(map(str, command))

        def finished() -> Finished:
            try:
                code = started.popen.wait(_COMMAND_LIMIT)
            except subprocess.TimeoutExpired:
                raise SourceError(f"{typed} takes more than {_COMMAND_LIMIT:g} s") from None
            if code not in codes:
                raise SourceError(f"{typed} failed ({code})")
            return Finished(typed, code, started.said())

        with self.running(command, environ, name) as started:
            yield finished

    def end(self, those: Sequence[Started]) -> None:
        """End processes together, and with force what they started and left behind."""
        with deferred():
            for number, grace in _GRACES:
                for started in _alive(those):
                    started.popen.send_signal(number)
                _wait(_alive(those), grace)
            end_kin({started.mark for started in those})
            self._running = [other for other in self._running if other not in those]


def _alive(those: Iterable[Started]) -> list[Started]:
    return [started for started in those if started.popen.poll() is None]


def _wait(those: Iterable[Started], limit: float) -> None:
    deadline = time.monotonic() + limit
    for started in those:
        with suppress(subprocess.TimeoutExpired):
            started.popen.wait(max(0.0, deadline - time.monotonic()))

"""Starts processes and ends them again, whatever happens; touches no others."""

import os
import signal
import socket
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType

from rtron.errors import SourceError

Environ = Mapping[str, str]
Command = Sequence[str | Path]
_GRACE = 20.0
_COMMAND_LIMIT = 60.0
_SHOWN = 2000


@dataclass(frozen=True, slots=True)
class Started:
    """A process of ours, and the file that it writes to."""

    popen: subprocess.Popen[bytes]
    log: Path

    def said(self) -> str:
        """Return what the process has written so far."""
        return self.log.read_text(encoding="utf-8", errors="replace")


def free_port() -> int:
    """Return a port that nobody listens on."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port: int = free.getsockname()[1]
        return port


class Processes:
    """The processes that were started here; on leaving, those that still run are ended.

    Each has a process group of its own, so that ^C reaches this process only, and this one ends
    the others in order. SIGTERM ends this process as ^C does.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._running: list[Started] = []

    def __enter__(self) -> "Processes":  # noqa: PYI034 - `Self` is not in Python 3.10
        signal.signal(signal.SIGTERM, signal.default_int_handler)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        while self._running:
            self._end(self._running[-1])

    def start(self, command: Command, environ: Environ) -> Started:
        """Start a process; what it says goes to a file."""
        log = self._folder / f"{len(list(self._folder.iterdir()))}-{Path(command[0]).name}.log"
        with log.open("wb") as output:
            popen = subprocess.Popen(  # noqa: S603 - the commands are the demo's own
                [str(word) for word in command],
                env=dict(environ),
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        started = Started(popen, log)
        self._running.append(started)
        return started

    @contextmanager
    def running(self, command: Command, environ: Environ) -> Iterator[Started]:
        """Run a process until the end of the block; a SourceError there shows what it said last."""
        started = self.start(command, environ)
        try:
            yield started
        except SourceError as error:
            raise SourceError(f"{error}\n{started.said()[-_SHOWN:]}") from error
        finally:
            self._end(started)

    def finish(self, command: Command, environ: Environ) -> str:
        """Run a command to its end and return what it printed; SourceError if it fails."""
        with self.running(command, environ) as started:
            with suppress(subprocess.TimeoutExpired):
                started.popen.wait(_COMMAND_LIMIT)
            if started.popen.poll() != 0:
                raise SourceError(f"{' '.join(map(str, command))} failed")
            return started.said()

    def _end(self, started: Started) -> None:
        """End a process, and with force what it started and left behind."""
        below = _descendants(started.popen.pid) if started.popen.poll() is None else {}
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
            if started.popen.poll() is None:
                started.popen.send_signal(number)
            with suppress(subprocess.TimeoutExpired):
                started.popen.wait(_GRACE)
                break
        for pid, birth in below.items():
            if _birth_and_parent(pid)[0] == birth:
                with suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
        self._running.remove(started)


def _descendants(root: int) -> dict[int, str]:
    """Return the processes below `root` and when each was born; a pid alone may be used again."""
    facts = {int(p.name): _birth_and_parent(int(p.name)) for p in Path("/proc").glob("[0-9]*")}
    found: dict[int, str] = {}
    parents = {root}
    while parents:
        children = {pid: birth for pid, (birth, parent) in facts.items() if parent in parents}
        found |= children
        parents = set(children)
    return found


def _birth_and_parent(pid: int) -> tuple[str, int]:
    """Return when a process was born (clock ticks) and its parent; ("", 0) if it is gone."""
    try:
        stat = Path("/proc", str(pid), "stat").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return "", 0
    fields = stat.rpartition(")")[2].split()
    return fields[19], int(fields[1])

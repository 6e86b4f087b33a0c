"""A file that a process writes its log to, line by line with the time each was seen."""

import time
from collections.abc import Callable
from pathlib import Path
from threading import Event, Thread

_POLL_S = 0.001


class LogWatcher:
    """Reads a growing file in a thread; `lines` are (ns of the steady clock, text)."""

    def __init__(self, path: Path) -> None:
        self.lines: list[tuple[int, str]] = []
        self._path = path
        self._ended = Event()
        self._thread = Thread(target=self._follow, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Read no more."""
        self._ended.set()
        self._thread.join()

    def find(self, text: str, after: int = 0) -> tuple[int, str] | None:
        """Return the first line with a word that came after `after` (ns), None before."""
        return next(
            (line for line in list(self.lines) if line[0] > after and text in line[1]), None
        )

    def wait(self, text: str, after: int, limit_s: float) -> tuple[int, str]:
        """Return the first such line, TimeoutError if it does not come."""
        deadline = time.monotonic() + limit_s
        while not (found := self.find(text, after)):
            if time.monotonic() > deadline:
                raise TimeoutError(f"{text!r} was not said within {limit_s:g} s")
            time.sleep(_POLL_S)
        return found

    def count(self, matches: Callable[[str], bool]) -> int:
        """Return how many lines match."""
        return sum(matches(text) for _, text in list(self.lines))

    def times(self, text: str) -> list[int]:
        """Return when each line with a word was seen, ns of the steady clock."""
        return [at for at, line in list(self.lines) if text in line]

    def _follow(self) -> None:
        with self._path.open("rb") as file:
            rest = b""
            while not self._ended.wait(_POLL_S):
                rest += file.read()
                *complete, rest = rest.split(b"\n")
                now = time.monotonic_ns()
                self.lines += [(now, line.decode(errors="replace")) for line in complete]

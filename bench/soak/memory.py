"""The memory of the guard's processes over their lives."""

import time
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass

from bench.common.process_usage import peak_resident_mb, resident_mb
from bench.soak.app import PROGRAMS, SoakedApp

_WARM_S = 30.0
_LIVED_S = 30.0


@dataclass(frozen=True, slots=True)
class Sample:
    """The memory of a process at a time (s): what it has, and the most that it has had, MB."""

    at: float
    resident: float
    peak: float


class MemoryWatch:
    """Samples what each process has, and returns how much the processes of a program grew."""

    def __init__(self, app: SoakedApp) -> None:
        self._app = app
        self._samples: dict[tuple[str, int], list[Sample]] = defaultdict(list)

    def sample(self) -> None:
        """Note what each has now."""
        for program in PROGRAMS:
            for pid in self._app.pids(program):
                try:
                    sample = Sample(time.monotonic(), resident_mb(pid), peak_resident_mb(pid))
                except (OSError, ProcessLookupError):
                    continue  # it has just ended
                self._samples[program, pid].append(sample)

    def growth(self, program: str) -> float | None:
        """Return by how much (MB) a process grew at most after its first half minute.

        None if no process of the program lived a minute.
        """
        return max(filter(None.__ne__, map(_growth, self._lives(program))), default=None)

    def peak(self, program: str) -> float:
        """Return the most memory that a process of the program has had, MB."""
        return max((each.peak for life in self._lives(program) for each in life), default=0.0)

    def _lives(self, program: str) -> Iterator[list[Sample]]:
        return (taken for (name, _), taken in self._samples.items() if name == program)


def _growth(life: list[Sample]) -> float | None:
    warm = [each for each in life if each.at - life[0].at >= _WARM_S]
    if not warm or warm[-1].at - warm[0].at < _LIVED_S:
        return None
    return warm[-1].resident - warm[0].resident

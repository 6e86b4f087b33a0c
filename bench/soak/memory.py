"""The memory of the guard's processes over their lives."""

import time
from collections import defaultdict
from dataclasses import dataclass

from bench.common.process_usage import resident_mb
from bench.soak.app import PROGRAMS, SoakedApp

_WARM_S = 30.0
_LIVED_S = 60.0


@dataclass(frozen=True, slots=True)
class Growth:
    """How much the memory of a program's process has grown (MB) since it was warm, in seconds."""

    program: str
    megabytes: float
    seconds: float


class MemoryWatch:
    """Samples what each process has, and tells how much those grew that lived for a while."""

    def __init__(self, app: SoakedApp) -> None:
        self._app = app
        self._samples: dict[tuple[str, int], list[tuple[float, float]]] = defaultdict(list)

    def sample(self) -> None:
        """Note what each has now."""
        for program in PROGRAMS:
            for pid in self._app.pids(program):
                try:
                    size = resident_mb(pid)
                except (OSError, ProcessLookupError):
                    continue  # it has just ended
                self._samples[program, pid].append((time.monotonic(), size))

    def growths(self) -> list[Growth]:
        """Return the growth of each process that lived a minute longer than its first half one."""
        found = (self._growth(program, taken) for (program, _), taken in self._samples.items())
        return [each for each in found if each.seconds >= _LIVED_S]

    def _growth(self, program: str, samples: list[tuple[float, float]]) -> Growth:
        warm = [each for each in samples if each[0] - samples[0][0] >= _WARM_S]
        if not warm:
            return Growth(program, 0.0, 0.0)
        return Growth(program, warm[-1][1] - warm[0][1], warm[-1][0] - warm[0][0])

"""Classify in a new process: `python -m evaluation.common.function_timing CORPUS [READMES]`.

It prints one JSON object: how many repositories there are, how many are decided, the seconds from
reading to the last classification, and the process's peak memory in MB.
"""

import json
import resource
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

_KIB_PER_MB = 1024


@dataclass(frozen=True, slots=True, kw_only=True)
class Timing:
    """A corpus that was classified: `seconds` with the loading of the rules, `peak` in MB."""

    repositories: int
    decided: int
    seconds: float
    peak: float


def timed(corpus: Path, readmes: Path | None = None) -> Timing:
    """Classify a corpus in a process of its own."""
    files = [str(path) for path in (corpus, readmes) if path]
    command = [sys.executable, "-m", "evaluation.common.function_timing", *files]
    done = subprocess.run(command, check=True, capture_output=True, text=True)  # noqa: S603 - ours
    return Timing(**json.loads(done.stdout))


def main(files: Sequence[str]) -> None:
    """Classify the corpus that is named, and print its timing."""
    started = time.perf_counter()
    from evaluation.common.function_corpora import classified  # noqa: PLC0415 - its loading is timed

    found = classified(*map(Path, files))
    timing = Timing(
        repositories=len(found),
        decided=sum(each.primary is not None for each in found.values()),
        seconds=time.perf_counter() - started,
        peak=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / _KIB_PER_MB,
    )
    print(json.dumps(asdict(timing)))  # noqa: T201 - what it is for


if __name__ == "__main__":
    main(sys.argv[1:])

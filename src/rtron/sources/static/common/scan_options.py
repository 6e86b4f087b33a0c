"""How a scan is run: over how many processes, for how long, with which cache."""

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias

Progress: TypeAlias = Callable[[int, int, str], None]
"""Told how many nodes are done, of how many known so far, and what is done now."""


def ignore_progress(done: int, known: int, what: str) -> None:
    """Take a scan's progress and tell nobody."""


def default_workers() -> int:
    """Return how many processes this one may keep busy."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanOptions:
    """`seconds` of processor time bound a node's interpretation; `cache` is a folder or None.

    `start_method` is how processes start (`multiprocessing`); without one, WorkerPool decides.
    """

    workers: int = field(default_factory=default_workers)
    seconds: float = 60.0
    start_method: str | None = None
    cache: Path | None = None
    progress: Progress = ignore_progress

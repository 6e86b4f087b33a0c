"""What a study is to run, and whom it tells what it does."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from rtron.demos.cases import Case
from rtron.demos.metrics.case_run import CaseRun

CAMERA_RATE = 10.0
"""Images a simulated second."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyRequest:
    """Which cases to run in the worlds of which seeds; `camera_rate` is in images a simulated s."""

    cases: Sequence[Case]
    seeds: Sequence[int]
    camera_rate: float = CAMERA_RATE


@dataclass(frozen=True, slots=True)
class ProgressListener:
    """Takes what happens now, and each run that is done."""

    on_activity: Callable[[str], None]
    on_run: Callable[[CaseRun], None]

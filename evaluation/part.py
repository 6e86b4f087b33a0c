"""A part of the evaluation, and whom it tells what it does."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from evaluation.common.datasets import Datasets
from figures.figure import Figure


@dataclass(frozen=True, slots=True)
class Reporter:
    """Takes what is being done, and lines for a person; `detail` is for those who ask for it."""

    progress: Callable[[str], None]
    lines: Callable[[Sequence[str]], None]
    detail: Callable[[Sequence[str]], None]


Part = Callable[[Datasets, Reporter], Iterator[Figure]]
"""Measures, and gives each figure as soon as it is known; raises AbsentError if it cannot."""

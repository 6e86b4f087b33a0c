"""Probabilities beside what was right."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

_BINS = (0.0, 0.5, 0.7, 0.8, 0.9, 0.95, 1.0)
Array: TypeAlias = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class ReliabilityBin:
    """Answers of about one probability: how many, their mean probability, the share right."""

    lowest: float
    highest: float
    answers: int
    predicted: float
    right: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Reliability:
    """Probabilities beside what was right; `base` is the Brier score of one fixed probability."""

    answers: int
    brier: float
    base: float
    calibration_error: float
    bins: tuple[ReliabilityBin, ...]


def reliability(probabilities: Array, right: Array) -> Reliability:
    """Return how well probabilities fit what was right."""
    bins = tuple(_bins(probabilities, right))
    errors = sum(each.answers * abs(each.predicted - each.right) for each in bins)
    return Reliability(
        answers=len(right),
        brier=float(np.mean((probabilities - right) ** 2)),
        base=float(np.var(right)),
        calibration_error=errors / max(len(right), 1),
        bins=bins,
    )


def reliability_lines(title: str, found: Reliability) -> Iterator[str]:
    """Yield the reliability as a table."""
    yield (
        f"{title}: {found.answers} answers, Brier {found.brier:.4f} (one fixed probability "
        f"{found.base:.4f}), calibration error {found.calibration_error:.3f}"
    )
    yield f"  {'probability':14}{'answers':>7}{'mean':>8}{'right':>8}"
    for each in found.bins:
        span = f"{each.lowest:.2f} to {each.highest:.2f}"
        yield f"  {span:14}{each.answers:>7}{each.predicted:>8.3f}{each.right:>8.3f}"


def _bins(probabilities: Array, right: Array) -> Iterator[ReliabilityBin]:
    for lowest, highest in pairwise(_BINS):
        is_last = highest == _BINS[-1]
        inside = (probabilities >= lowest) & ((probabilities < highest) | is_last)
        if inside.any():
            yield ReliabilityBin(
                lowest=lowest,
                highest=highest,
                answers=int(inside.sum()),
                predicted=float(probabilities[inside].mean()),
                right=float(right[inside].mean()),
            )

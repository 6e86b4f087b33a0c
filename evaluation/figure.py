"""A figure: ours beside a peer's, with the bound that it should keep."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from evaluation.place import Place


@dataclass(frozen=True, slots=True)
class Tell:
    """Takes what is being done, and lines for a person; `detail` is for those who ask for it."""

    progress: Callable[[str], None]
    lines: Callable[[Sequence[str]], None]
    detail: Callable[[Sequence[str]], None]


@dataclass(frozen=True, slots=True)
class Figure:
    """One line of the table."""

    name: str
    ours: float
    peer: float | None
    unit: str
    at_least: float | None = None
    at_most: float | None = None

    @property
    def ratio(self) -> float | None:
        """Return ours / peer; None without a peer, or one that is nothing."""
        return self.ours / self.peer if self.peer else None

    @property
    def met(self) -> bool | None:
        """Tell whether the figure keeps its bounds, None if it has none."""
        low = self.at_least is None or self.ours >= self.at_least
        high = self.at_most is None or self.ours <= self.at_most
        return None if self.at_least is None and self.at_most is None else low and high

    def as_json(self) -> dict[str, float | str | None]:
        """Return the figure as build/eval.json has it."""
        return {"ours": self.ours, "peer": self.peer, "ratio": self.ratio, "unit": self.unit}


Part = Callable[[Place, Tell], Iterator[Figure]]
"""Measures, and gives each figure as soon as it is known; raises AbsentError if it cannot."""

"""A figure: ours beside a peer's, with the bounds that it should keep."""

import statistics
from collections.abc import Iterator, Sequence
from dataclasses import KW_ONLY, dataclass

Range = tuple[float, float]
"""The lowest and the highest value of several runs."""


@dataclass(frozen=True, slots=True)
class Spread:
    """How interleaved runs differ: the ratio is the median of the runs' own ratios."""

    ours: Range | None
    peer: Range | None
    ratio: Range | None
    median_ratio: float | None


@dataclass(frozen=True, slots=True)
class Figure:
    """One line of the table."""

    name: str
    ours: float
    peer: float | None
    unit: str
    _: KW_ONLY
    at_least: float | None = None
    at_most: float | None = None
    ratio_at_most: float | None = None
    spread: Spread | None = None

    @classmethod
    def of_runs(
        cls,
        name: str,
        ours: Sequence[float],
        peer: Sequence[float],
        unit: str,
        *,
        at_most: float | None = None,
        ratio_at_most: float | None = None,
    ) -> "Figure":
        """Return the medians over runs, of the ratios too; without a peer it is empty."""
        ratios = [_ratio_of(*pair) for pair in zip(ours, peer, strict=bool(peer))]
        spread = Spread(_range(ours), _range(peer), _range(ratios), _median(ratios))
        bounds = {"at_most": at_most, "ratio_at_most": ratio_at_most}
        middle = statistics.median(ours)
        return cls(name, middle, _median(peer), unit, **bounds, spread=spread)

    @property
    def ratio(self) -> float | None:
        """Return ours / peer; None without a peer, or where noise made a difference negative."""
        if self.spread:
            return self.spread.median_ratio
        if self.peer is None or self.peer <= 0 or self.ours < 0:
            return None
        return self.ours / self.peer

    @property
    def met(self) -> bool | None:
        """Tell whether the figure keeps its bounds, None if it has none."""
        answers = list(self._answers())
        return all(answers) if answers else None

    def _answers(self) -> Iterator[bool]:
        if self.at_least is not None:
            yield self.ours >= self.at_least
        if self.at_most is not None:
            yield self.ours <= self.at_most
        if self.ratio_at_most is not None:
            yield self.ratio is not None and self.ratio <= self.ratio_at_most

    def as_json(self) -> dict[str, float | str | Range | None]:
        """Return the figure as the JSON has it."""
        values: dict[str, float | str | Range | None]
        values = {"ours": self.ours, "peer": self.peer, "ratio": self.ratio, "unit": self.unit}
        if self.spread is None:
            return values
        ranges = self.spread.ours, self.spread.peer, self.spread.ratio
        return values | dict(zip(("ours_range", "peer_range", "ratio_range"), ranges, strict=True))


_NO_RATIO = 1000.0
"""The ratio to a peer that costs nothing."""


def _ratio_of(ours: float, peer: float) -> float:
    """Return the ratio in one run; noise can make what is added on the way negative."""
    if ours <= min(peer, 0):
        return 0.0
    return max(0.0, ours) / peer if peer > 0 else _NO_RATIO


def _range(values: Sequence[float]) -> Range | None:
    return (min(values), max(values)) if values else None


def _median(values: Sequence[float]) -> float | None:
    return statistics.median(values) if values else None

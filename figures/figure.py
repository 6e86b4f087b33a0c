"""A figure: ours beside a peer's, with the bounds that it should keep."""

from collections.abc import Iterator
from dataclasses import KW_ONLY, dataclass


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

    @property
    def ratio(self) -> float | None:
        """Return ours / peer; None without a peer, or where noise made a difference negative."""
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

    def as_json(self) -> dict[str, float | str | None]:
        """Return the figure as the JSON has it."""
        return {"ours": self.ours, "peer": self.peer, "ratio": self.ratio, "unit": self.unit}

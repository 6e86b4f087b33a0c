"""A figure: ours beside a peer's, with what it should be at most."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from bench.site import Site

Say = Callable[[str], None]
"""Tells what is being done."""
Part = Callable[[Site, Say], Iterator["Figure"]]
"""Measures, and gives each figure as soon as it is known."""


@dataclass(frozen=True, slots=True)
class Figure:
    """One line of the table; less is better in all of them."""

    name: str
    ours: float
    peer: float | None
    unit: str
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
        """Tell whether the figure is what it should be, None if nothing is asked of it."""
        asked = [(self.ours, self.at_most), (self.ratio, self.ratio_at_most)]
        answers = [value is not None and value <= most for value, most in asked if most is not None]
        return all(answers) if answers else None

    def as_json(self) -> dict[str, float | str | None]:
        """Return the figure as build/bench.json has it."""
        return {"ours": self.ours, "peer": self.peer, "ratio": self.ratio, "unit": self.unit}

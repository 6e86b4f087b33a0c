"""Precision and recall over pairs of node and name."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from evaluation.ros1.architecture import KINDS, Architecture, Pairs, with_actions, without_ignored


@dataclass(frozen=True, slots=True)
class Score:
    """What was observed and what was recovered, of one kind."""

    observed: Pairs
    recovered: Pairs

    @property
    def hits(self) -> int:
        """Return how many pairs were observed and recovered."""
        return len(self.observed & self.recovered)

    @property
    def precision(self) -> float:
        """Return the share of the recovered pairs that were observed; 1 if none was recovered."""
        return self.hits / len(self.recovered) if self.recovered else 1.0

    @property
    def recall(self) -> float:
        """Return the share of the observed pairs that were recovered; 1 if none was observed."""
        return self.hits / len(self.observed) if self.observed else 1.0

    def differences(self) -> Iterator[str]:
        """Yield a line for each pair that was missed or invented."""
        for word, pairs in (
            ("MISSED", self.observed - self.recovered),
            ("EXTRA", self.recovered - self.observed),
        ):
            yield from (f"{word:6} {node} {name}" for node, name in sorted(pairs))


def score(observed: Architecture, recovered: Architecture, *, raw: bool) -> Mapping[str, Score]:
    """Return the score of each kind, with nothing ignored if `raw`."""
    if not raw:
        observed, recovered = without_ignored(observed), without_ignored(recovered)
    observed_pairs, found = with_actions(observed), with_actions(recovered)
    return {kind: Score(getattr(observed_pairs, kind), getattr(found, kind)) for kind in KINDS}

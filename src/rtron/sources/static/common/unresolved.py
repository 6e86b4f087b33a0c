"""What could not be found out, gathered while an app is read."""

from dataclasses import dataclass, field

from rtron.vocabulary import Evidence, UnresolvedItem


@dataclass(slots=True)
class UnresolvedList:
    """Notes in the order in which they came up."""

    entries: list[UnresolvedItem] = field(default_factory=list)

    def add(self, what: str, why: str, location: Evidence) -> None:
        """Note what is unresolved, why, and where."""
        self.entries.append(UnresolvedItem(what=what, why=why, evidence=(location,)))

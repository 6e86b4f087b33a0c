"""What could not be found out, gathered while an app is read."""

from dataclasses import dataclass, field

from rtron.vocabulary import Evidence, Unresolved


@dataclass(slots=True)
class Notes:
    """Notes in the order in which they came up."""

    unresolved: list[Unresolved] = field(default_factory=list)

    def add(self, what: str, why: str, place: Evidence) -> None:
        """Note what is unresolved, why, and where."""
        self.unresolved.append(Unresolved(what=what, why=why, evidence=(place,)))

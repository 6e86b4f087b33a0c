"""What could not be found out, gathered while an app is read."""

from dataclasses import dataclass, field

from rtron.vocabulary import Evidence, UnresolvedCause, UnresolvedItem
from rtron.vocabulary.enums import HiddenPart


@dataclass(slots=True)
class UnresolvedList:
    """Notes in the order in which they came up."""

    entries: list[UnresolvedItem] = field(default_factory=list)

    def add(
        self,
        what: str,
        why: str,
        location: Evidence,
        hides: HiddenPart | None = None,
        cause: UnresolvedCause | None = None,
    ) -> None:
        """Note what is unresolved, why, and where, and what may be behind it."""
        note = UnresolvedItem(what=what, why=why, hides=hides, cause=cause, evidence=(location,))
        self.entries.append(note)

"""The notes of a scan by what somebody can do about them, what is to be given first."""

from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from rtron.vocabulary import UnresolvedCause, UnresolvedItem

_MODEL = "write a model: `rtron model draft`"


@dataclass(frozen=True, slots=True)
class NoteKind:
    """Notes of one kind: what they say together, and what to do about it.

    `has_causes` says that each has something to tell of its own.
    """

    title: str
    remedy: str
    has_causes: bool = True


_NOT_IN_APP = NoteKind(
    "The app names what is not there",
    "correct the launch file, or add the file to its package and its build files",
)
_VALUES = NoteKind(
    "Values that are not given", "--env NAME=VALUE for a variable, NAME:=VALUE for an argument"
)
_READ_IN_PART = NoteKind(
    "Programs that are read in part only", f"look at these places yourself, or {_MODEL}"
)
_KINDS: dict[UnresolvedCause | None, NoteKind] = {
    UnresolvedCause.MISSING_SOURCE: NoteKind(
        "Source that is not here", f"give the folder of its source, or {_MODEL}"
    ),
    UnresolvedCause.UNSET_VARIABLE: _VALUES,
    UnresolvedCause.ARGUMENT: _VALUES,
    UnresolvedCause.MISSING_CODE: NoteKind(
        "Code that is not here and may add endpoints", "give the folder of its source too"
    ),
    UnresolvedCause.SYNTAX_ERROR: NoteKind(
        "Errors in the source", "correct these places, and scan again"
    ),
    UnresolvedCause.PARTLY_READ: _READ_IN_PART,
    UnresolvedCause.LIMIT: _READ_IN_PART,
    UnresolvedCause.RUN_TIME: NoteKind(
        "Known only while the app runs", "read the running app: rtron scan --live"
    ),
    UnresolvedCause.UNREACHED: NoteKind(
        "Functions that nothing which is seen calls", "none, if nothing calls them"
    ),
    None: NoteKind("Not followed in the source", "look at these places yourself"),
    UnresolvedCause.INCOMPLETE_DESCRIPTION: NoteKind(
        "In robot descriptions, because files that they include are not here",
        "nothing to do here: give these files",
        has_causes=False,
    ),
}


def group_notes(notes: Iterable[UnresolvedItem]) -> Iterator[tuple[NoteKind, list[UnresolvedItem]]]:
    """Yield the kinds that there are, what somebody can give first; each note is in one."""
    found: dict[NoteKind, list[UnresolvedItem]] = defaultdict(list)
    for note in notes:
        found[_NOT_IN_APP if note.missing else _KINDS[note.cause]].append(note)
    for kind in dict.fromkeys((_NOT_IN_APP, *_KINDS.values())):
        if kind in found:
            yield kind, found[kind]

"""The notes of a scan by what somebody can do about them, what is to be given first."""

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from rtron.vocabulary import UnresolvedItem

_MODEL = "write a model: `rtron model draft`"


@dataclass(frozen=True, slots=True)
class NoteKind:
    """Notes of one kind: what they say together, and what to do about it; `form` tells them.

    `has_causes` says that each has something to tell of its own.
    """

    title: str
    remedy: str
    form: re.Pattern[str]
    has_causes: bool = True


@dataclass(frozen=True, slots=True)
class NoteGroup:
    """The notes of a kind in the order of the scan."""

    kind: NoteKind
    notes: tuple[UnresolvedItem, ...]


def _kind(title: str, remedy: str, *forms: str) -> NoteKind:
    return NoteKind(title, remedy, re.compile("|".join(forms)))


_NOT_IN_APP = _kind(
    "The app names what is not there",
    "correct the launch file, or add the file to its package and its build files",
    "(?!)",
)
_FOLLOWS = NoteKind(
    "In robot descriptions, because files that they include are not here",
    "nothing to do here: give these files",
    re.compile("(?!)"),
    has_causes=False,
)
_KINDS = (
    _kind(
        "Source that is not here",
        f"give the folder of its source, or {_MODEL}",
        "no source of it is here",
        "its package is not here",
        r"package '[^']+' is not (?:here|found)",
        "is a ROS package that is not in the source",
    ),
    _kind(
        "Values that are not given",
        "--env NAME=VALUE for a variable, NAME:=VALUE for an argument",
        r"\Aenvironment variable ",
        r"\Alaunch argument ",
        r"\Aargument .* is not given",
    ),
    _kind(
        "Code that is not here and may add endpoints",
        "give the folder of its source too",
        "its code is not here",
        "its source is not found",
        "its class is not in the sources",
        "its base class .* is not in the source",
        "its file is not in the folders that are read",
        "nothing that is read registers it",
        "no model of it",
    ),
    _kind(
        "Errors in the source",
        "correct these places, and scan again",
        r": (?:all from here is )?left out: ",
    ),
    _kind(
        "Programs that are read in part only",
        "look at these places yourself, or write a model: `rtron model draft`",
        "too large",
        "not done within",
        "nested too deep",
        "RTron failed at it",
        "cannot be read",
        "not read",
        "ends it before all of it is run",
        "not all of it is run",
    ),
    _kind(
        "Known only while the app runs",
        "read the running app: rtron scan --live",
        "before the app runs",
        "a callback may make it again",
        "only an exception handler declares it",
        "leaves open whether this is made",
    ),
    _kind(
        "Functions that nothing which is seen calls",
        "none, if nothing calls them",
        "nothing that is seen calls it",
    ),
)
_REST = _kind("Not followed in the source", "look at these places yourself", "")
_MISSING_INCLUDE = re.compile(r"\Ainclude .*(?:is not found|is not here|cannot be read)")
_DESCRIPTION_FAULT = re.compile(r"there is no macro of this name|property '\w+' is not defined")
_DESCRIPTIONS = (".xacro", ".urdf")


def group_notes(notes: Iterable[UnresolvedItem]) -> Iterator[NoteGroup]:
    """Yield the kinds that there are, what somebody can give first; each note is in one."""
    notes = tuple(notes)
    is_include_missing = any(map(_is_missing_include, notes))
    found: dict[str, list[UnresolvedItem]] = defaultdict(list)
    for note in notes:
        follows = is_include_missing and _is_description_fault(note)
        kind = _FOLLOWS if follows else _kind_of(note)
        found[kind.title].append(note)
    for kind in (_NOT_IN_APP, *_KINDS, _REST, _FOLLOWS):
        if kind.title in found:
            yield NoteGroup(kind, tuple(found[kind.title]))


def _kind_of(note: UnresolvedItem) -> NoteKind:
    if note.missing:
        return _NOT_IN_APP
    text = f"{note.what}: {note.why}"
    return next((kind for kind in _KINDS if kind.form.search(text)), _REST)


def _is_missing_include(note: UnresolvedItem) -> bool:
    return _is_of_description(note) and bool(_MISSING_INCLUDE.search(f"{note.what}: {note.why}"))


def _is_description_fault(note: UnresolvedItem) -> bool:
    return _is_of_description(note) and bool(_DESCRIPTION_FAULT.search(note.why))


def _is_of_description(note: UnresolvedItem) -> bool:
    return any(place.file.endswith(_DESCRIPTIONS) for place in note.evidence)

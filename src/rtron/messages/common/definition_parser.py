"""From the text of a definition, with all the types that it names, to the Definition.

The text is a stranger's: it is read line by line, bounded, and never becomes code. It is not read
with rosbags' parser, since that drops the spelling of constants, which the MD5 sum needs, and
cannot say in which line a fault is.
"""

import hashlib
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from rtron.errors import InputError
from rtron.messages.common.definition import HEADER, PRIMITIVES, Definition, Field
from rtron.vocabulary import normalise_type

MAX_FIELDS = 1 << 10
"""The most fields of all the types in one definition."""
MAX_VALUES = 1 << 16
"""The most values in a message, with one element in each sequence and each primitive array."""

NAME = re.compile(r"[A-Za-z]\w*/[A-Za-z]\w*", re.ASCII)
"""A message type in ROS 1 spelling."""
_ALIASES = {
    "Header": HEADER,
    "roslib/Header": HEADER,
    "builtin_interfaces/Time": "time",
    "builtin_interfaces/Duration": "duration",
}
_TYPE = re.compile(
    r"(?P<base>[A-Za-z]\w*(?:/[A-Za-z]\w*){0,2})(?:<=(?P<longest>\d+))?"
    r"(?P<array>\[(?:<=(?P<most>\d+)|(?P<length>\d*))\])?",
    re.ASCII,
)
_LINE = re.compile(r"\s*(?P<type>\S+)\s+(?P<name>[A-Za-z]\w*)\s*(?P<rest>=|\s\S|$)", re.ASCII)
_DIGITS = 10
_SEPARATOR = re.compile(r"={3,}\s*")
_SECTION = re.compile(r"MSG:\s*(\S+)\s*")


@dataclass(slots=True)
class Section:
    """One type's part of a text."""

    fields: list[Field]
    hashed: list[str]
    """What the MD5 sum is made of: constants, as they are spelled."""
    lines: list[int]


def parse_sections(name: str, text: str) -> dict[str, Section]:
    """Return the types that a text defines; of one defined twice the first counts."""
    found: dict[str, Section] = {}
    section = found[name] = Section([], [], [])
    separated = False
    count = 0
    for number, line in enumerate(text.splitlines(), 1):
        if _SEPARATOR.fullmatch(line):
            separated = True
        elif separated and (heading := _SECTION.fullmatch(line)):
            name = normalise_type(heading[1])
            section = Section([], [], [])
            found.setdefault(name, section)
            separated = False
        elif line.partition("#")[0].strip():
            _read_line(line, number, name, section)
            count = count + 1
            if count > MAX_FIELDS:
                raise InputError(f"line {number}: more than {MAX_FIELDS} fields and constants")
    return found


def _read_line(line: str, number: int, owner: str, section: Section) -> None:
    parts = _LINE.match(line.partition("#")[0])
    kind = _TYPE.fullmatch(parts["type"]) if parts else None
    if parts is None or kind is None:
        raise InputError(
            f"line {number}: neither a field nor a constant: {line.strip()[:80]!r}",
            help="a field is `type name`, a constant `type NAME=value`",
        )
    if parts["rest"] == "=":
        value = line if kind["base"] == "string" else line.partition("#")[0]
        section.hashed.append(f"{kind[0]} {parts['name']}={value.partition('=')[2].strip()}")
        return
    if any(each.name == parts["name"] for each in section.fields):
        raise InputError(f"line {number}: there are two fields {parts['name']}")
    section.fields.append(_field(parts["name"], kind, number, owner))
    section.lines.append(number)


def _field(name: str, kind: "re.Match[str]", line: int, owner: str) -> Field:
    length = kind["length"] or None
    if length and (len(length) > len(str(MAX_VALUES)) or not 0 < int(length) <= MAX_VALUES):
        raise InputError(f"line {line}: {name} has {length[:20]} elements, at most {MAX_VALUES}")
    if kind["longest"] and kind["base"] != "string":
        raise InputError(f"line {line}: {kind['base']} of {name} is no string and has no length")
    return Field(
        name=name,
        type=_resolved(kind["base"], line, owner),
        array=kind["array"] is not None,
        length=int(length) if length else None,
        max_elements=_parse_bound(kind["most"]),
        max_bytes=_parse_bound(kind["longest"]),
    )


def _parse_bound(digits: str | None) -> int | None:
    """Return a bound; one above what 32 bits count bounds nothing."""
    return int(digits) if digits and len(digits) <= _DIGITS else None


def _resolved(base: str, line: int, owner: str) -> str:
    """Return a field's type: primitive, or in full and in ROS 1 spelling."""
    if base in PRIMITIVES:
        return base
    name = normalise_type(base)
    name = _ALIASES.get(name, name)
    if name in PRIMITIVES or NAME.fullmatch(name):
        return name
    if base == "wstring" or "/" in base:
        raise InputError(f"line {line}: {base} is no type that RTron reads")
    return f"{owner.partition('/')[0]}/{base}"


MAX_TEXT = 1 << 16
"""The longest definition accepted, in characters."""
MAX_DEPTH = 16
"""How deep types may be nested."""

Lookup = Callable[[str], Definition | None]


def parse_definition(type: str, text: str, *, lookup: Lookup | None = None) -> Definition:
    """Return the definition of `type` that `text` gives; InputError with the line if it is none.

    Other types follow after lines of `=` and `MSG: pkg/Name`; `lookup` may know those that do not.
    Both `.msg` spellings are read, ROS 1's and ROS 2's; wide strings are not (how they travel
    is each middleware's own).
    """
    name = normalise_type(type)
    if not NAME.fullmatch(name):
        raise InputError(f"{type!r} is not a message type", help="write it as pkg/Name")
    if len(text) > MAX_TEXT:
        raise InputError(f"the definition of {name} is longer than {MAX_TEXT} characters")
    return _DefinitionBuilder(parse_sections(name, text), lookup or _no_lookup).build(name)


class _DefinitionBuilder:
    """Puts the sections of one text together, each type once."""

    def __init__(self, sections: Mapping[str, Section], lookup: Lookup) -> None:
        self._sections = sections
        self._lookup = lookup
        self._built: dict[str, Definition] = {}
        self._open: list[str] = []

    def build(self, name: str) -> Definition:
        """Return the definition of the type `name`."""
        enter_type(name, self._open)
        section = self._sections[name]
        nested = {
            each.type: self._nested(each, line)
            for each, line in zip(section.fields, section.lines, strict=True)
            if each.type not in PRIMITIVES
        }
        self._open.pop()
        return _definition(name, section, nested)

    def _nested(self, field: Field, line: int) -> Definition:
        if field.type not in self._built:
            if field.type in self._sections:
                found: Definition | None = self.build(field.type)
            else:
                found = self._lookup(field.type)
            if found is None:
                raise InputError(
                    f"line {line}: the type {field.type} of {field.name} is not defined",
                    help=f"add a line of = and `MSG: {field.type}` with its fields",
                )
            self._built[field.type] = found
        return self._built[field.type]


def _definition(name: str, section: Section, nested: Mapping[str, Definition]) -> Definition:
    values = sum(
        nested[each.type].values * (each.length or 1) if each.type in nested else 1
        for each in section.fields
    )
    if values > MAX_VALUES:
        raise InputError(f"{name} has more than {MAX_VALUES} values")
    depth = 1 + max((each.depth for each in nested.values()), default=0)
    if depth > MAX_DEPTH:
        raise _too_deep(name)
    hashed = (*section.hashed, *(_hashed(each, nested) for each in section.fields))
    text = "\n".join(hashed)
    return Definition(
        type=name,
        fields=tuple(section.fields),
        md5sum=hashlib.md5(text.encode(), usedforsecurity=False).hexdigest(),
        nested=nested,
        values=max(values, 1),
        depth=depth,
        md5_text=text,
    )


def _hashed(field: Field, nested: Mapping[str, Definition]) -> str:
    if field.type in nested:
        return f"{nested[field.type].md5sum}{_spelled(field.max_elements)} {field.name}"
    length = _spelled(field.max_elements) if field.length is None else field.length
    array = f"[{length}]" if field.array else ""
    return f"{field.type}{_spelled(field.max_bytes)}{array} {field.name}"


def _spelled(bound: int | None) -> str:
    return "" if bound is None else f"<={bound}"


def enter_type(name: str, opened: list[str]) -> None:
    """Note that the definition of a type is being made; InputError if it already is."""
    if name in opened:
        raise InputError(f"a message type contains itself: {' -> '.join([*opened, name])}")
    if len(opened) >= MAX_DEPTH:
        raise _too_deep(opened[0])
    opened.append(name)


def _too_deep(name: str) -> InputError:
    return InputError(f"{name} is nested deeper than {MAX_DEPTH}")


def _no_lookup(_: str) -> None:
    return None

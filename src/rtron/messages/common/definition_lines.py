"""The lines of a definition's text, as fields and constants (ROS wiki: msg).

The text is a stranger's: it is read line by line, bounded, and never becomes code. It is not read
with rosbags' parser, since that drops the spelling of constants, which the MD5 sum needs, and
cannot say in which line a fault is.
"""

import re
from dataclasses import dataclass

from rtron.errors import InputError
from rtron.messages.common.definition import HEADER, PRIMITIVES, Field
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

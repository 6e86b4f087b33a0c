"""Definitions of message types, from the text that a publisher or a bag gives (ROS wiki: msg).

The text is a stranger's: it is read line by line, bounded, and never becomes code. It is not read
with rosbags' parser, since that drops the spelling of constants, which the MD5 sum needs, and
cannot say in which line a fault is.
"""

import hashlib
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

from rtron.errors import InputError
from rtron.vocabulary import MessageDefinition, normalise_type

MAX_TEXT = 1 << 16
"""The longest definition accepted, in characters."""
MAX_FIELDS = 1 << 10
"""The most fields of all the types in one definition."""
MAX_DEPTH = 16
"""How deep types may be nested."""
MAX_VALUES = 1 << 16
"""The most values in a message, with one element in each sequence and each primitive array."""

HEADER = "std_msgs/Header"
SIZES = {
    "bool": 1,
    "byte": 1,
    "char": 1,
    "int8": 1,
    "uint8": 1,
    "int16": 2,
    "uint16": 2,
    "int32": 4,
    "uint32": 4,
    "float32": 4,
    "int64": 8,
    "uint64": 8,
    "float64": 8,
    "time": 8,
    "duration": 8,
}
"""The bytes that a primitive value takes, except a string's."""
PRIMITIVES = frozenset({*SIZES, "string"})
_ALIASES = {
    "Header": HEADER,
    "roslib/Header": HEADER,
    "builtin_interfaces/Time": "time",
    "builtin_interfaces/Duration": "duration",
}
_NAME = re.compile(r"[A-Za-z]\w*/[A-Za-z]\w*", re.ASCII)
_TYPE = re.compile(
    r"(?P<base>[A-Za-z]\w*(?:/[A-Za-z]\w*){0,2})(?:<=\d+)?(?P<array>\[(?:<=\d+|(?P<length>\d*))\])?",
    re.ASCII,
)
_LINE = re.compile(r"\s*(?P<type>\S+)\s+(?P<name>[A-Za-z]\w*)\s*(?P<rest>=|\s\S|$)", re.ASCII)
_SEPARATOR = re.compile(r"={3,}\s*")
_SECTION = re.compile(r"MSG:\s*(\S+)\s*")


@dataclass(frozen=True, slots=True, kw_only=True)
class Field:
    """A field: `type` is primitive or `pkg/Name`, `length` that of an array of fixed length."""

    name: str
    type: str
    array: bool = False
    length: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Definition:
    """A message type, `pkg/Name`, with the definitions of the types that its own fields have.

    `md5sum` is ROS 1's, `values` as for `MAX_VALUES`, `depth` 1 if no type is nested in it.
    """

    type: str
    fields: tuple[Field, ...]
    md5sum: str
    nested: Mapping[str, "Definition"] = field(default_factory=dict, repr=False, compare=False)
    values: int = field(default=1, repr=False, compare=False)
    depth: int = field(default=1, repr=False, compare=False)

    def find(self, name: str) -> Field | None:
        """Return the field called `name`."""
        return next((each for each in self.fields if each.name == name), None)


Lookup = Callable[[str], Definition | None]


def parse_definition(type: str, text: str, *, lookup: Lookup | None = None) -> Definition:
    """Return the definition of `type` that `text` gives; InputError with the line if it is none.

    Other types follow after lines of `=` and `MSG: pkg/Name`; `lookup` may know those that do not.
    Both `.msg` spellings are read, ROS 1's and ROS 2's; wide strings are not.
    """
    name = normalise_type(type)
    if not _NAME.fullmatch(name):
        raise InputError(f"{type!r} is not a message type", help="write it as pkg/Name")
    if len(text) > MAX_TEXT:
        raise InputError(f"the definition of {name} is longer than {MAX_TEXT} characters")
    return _Builder(_sections(name, text), lookup or _nobody_knows).build(name)


class Definitions:
    """The message types that a plan defines, and the standard ones of ROS 1 or ROS 2."""

    def __init__(self, messages: Iterable[MessageDefinition] = (), *, ros: int = 1) -> None:
        self._texts = {normalise_type(each.type): each.definition for each in messages}
        self._ros = ros
        self._found: dict[str, Definition | None] = {}
        self._open: list[str] = []

    def find(self, type: str) -> Definition | None:
        """Return the definition of `type`, the plan's before the standard one; None if unknown.

        InputError if the plan's is wrong.
        """
        name = normalise_type(type)
        if name not in self._found:
            _open(name, self._open)
            try:
                self._found[name] = self._parse(name)
            finally:
                self._open.pop()
        return self._found[name]

    def _parse(self, name: str) -> Definition | None:
        text = self._texts.get(name) or _ACKERMANN.get(name)
        if text is not None:
            return parse_definition(name, text, lookup=self.find)
        standard = _standard_text(name, self._ros)
        return None if standard is None else parse_definition(name, standard)


@dataclass(slots=True)
class _Section:
    fields: list[Field]
    hashed: list[str]
    """What the MD5 sum is made of: constants, as they are spelled."""
    lines: list[int]


class _Builder:
    """Puts the sections of one text together, each type once."""

    def __init__(self, sections: Mapping[str, _Section], lookup: Lookup) -> None:
        self._sections = sections
        self._lookup = lookup
        self._built: dict[str, Definition] = {}
        self._open: list[str] = []

    def build(self, name: str) -> Definition:
        """Return the definition of the type `name`."""
        _open(name, self._open)
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


def _definition(name: str, section: _Section, nested: Mapping[str, Definition]) -> Definition:
    values = sum(
        nested[each.type].values * (each.length or 1) if each.type in nested else 1
        for each in section.fields
    )
    if values > MAX_VALUES:
        raise InputError(f"{name} has more than {MAX_VALUES} values")
    depth = 1 + max((each.depth for each in nested.values()), default=0)
    if depth > MAX_DEPTH:
        raise _too_deep(name)
    hashed = [*section.hashed, *(_hashed(each, nested) for each in section.fields)]
    return Definition(
        type=name,
        fields=tuple(section.fields),
        md5sum=hashlib.md5("\n".join(hashed).encode(), usedforsecurity=False).hexdigest(),
        nested=nested,
        values=max(values, 1),
        depth=depth,
    )


def _hashed(field: Field, nested: Mapping[str, Definition]) -> str:
    if field.type in nested:
        return f"{nested[field.type].md5sum} {field.name}"
    length = "" if field.length is None else field.length
    return f"{field.type}{f'[{length}]' if field.array else ''} {field.name}"


def _open(name: str, opened: list[str]) -> None:
    if name in opened:
        raise InputError(f"a message type contains itself: {' -> '.join([*opened, name])}")
    if len(opened) >= MAX_DEPTH:
        raise _too_deep(opened[0])
    opened.append(name)


def _too_deep(name: str) -> InputError:
    return InputError(f"{name} is nested deeper than {MAX_DEPTH}")


def _nobody_knows(_: str) -> None:
    return None


def _sections(name: str, text: str) -> dict[str, _Section]:
    """Return the types that a text defines; of one defined twice the first counts."""
    found: dict[str, _Section] = {}
    section = found[name] = _Section([], [], [])
    separated = False
    count = 0
    for number, line in enumerate(text.splitlines(), 1):
        if _SEPARATOR.fullmatch(line):
            separated = True
        elif separated and (heading := _SECTION.fullmatch(line)):
            name = normalise_type(heading[1])
            section = _Section([], [], [])
            found.setdefault(name, section)
            separated = False
        elif line.partition("#")[0].strip():
            _read_line(line, number, name, section)
            count = count + 1
            if count > MAX_FIELDS:
                raise InputError(f"line {number}: more than {MAX_FIELDS} fields and constants")
    return found


def _read_line(line: str, number: int, owner: str, section: _Section) -> None:
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
    return Field(
        name=name,
        type=_resolved(kind["base"], line, owner),
        array=kind["array"] is not None,
        length=int(length) if length else None,
    )


def _resolved(base: str, line: int, owner: str) -> str:
    """Return a field's type: primitive, or in full and in ROS 1 spelling."""
    if base in PRIMITIVES:
        return base
    name = normalise_type(base)
    name = _ALIASES.get(name, name)
    if name in PRIMITIVES or _NAME.fullmatch(name):
        return name
    if base == "wstring" or "/" in base:
        raise InputError(f"line {line}: {base} is no type that RTron reads")
    return f"{owner.partition('/')[0]}/{base}"


def _standard_text(name: str, ros: int) -> str | None:
    from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415 - most guards need none
    from rosbags.typesys.base import TypesysError  # noqa: PLC0415

    store = get_typestore(Stores.ROS1_NOETIC if ros == 1 else Stores.ROS2_HUMBLE)
    package, _, last = name.partition("/")
    try:
        return str(store.generate_msgdef(f"{package}/msg/{last}", ros_version=ros)[0])
    except TypesysError:
        return None


_DRIVE = "\n".join(
    f"float32 {name}"
    for name in ("steering_angle", "steering_angle_velocity", "speed", "acceleration", "jerk")
)
_ACKERMANN = {
    "ackermann_msgs/AckermannDrive": _DRIVE,
    "ackermann_msgs/AckermannDriveStamped": "Header header\nAckermannDrive drive",
}

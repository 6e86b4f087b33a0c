"""From the text of a definition, with all the types that it names, to the Definition."""

import hashlib
from collections.abc import Callable, Mapping

from rtron.errors import InputError
from rtron.messages.common.definition import PRIMITIVES, Definition, Field
from rtron.messages.common.definition_lines import MAX_VALUES, NAME, Section, parse_sections
from rtron.vocabulary import normalise_type

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

"""A macro as it is defined: its body and its parameters with their defaults (ROS wiki: xacro)."""

import re
from dataclasses import dataclass, field

from rtron.sources.xacro.xml_element import XmlElement

_DEFAULT = re.compile(
    r"\s*(?P<name>[^\s:=]+?)\s*:?=\s*(?P<forward>\^\|?)?"
    r"(?P<default>\$\{[^}]*\}|\$\([^)]*\)|(?:'[^']*'|\"[^\"]*\"|[^\s'\"])+|)(?:\s+|$)"
)
_PLAIN = re.compile(r"\s*(\S+)\s*")


@dataclass(frozen=True, slots=True, kw_only=True)
class Default:
    """A parameter's default: the caller's property of the same name (`forward`), or a text."""

    text: str | None
    forward: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Macro:
    """A macro; its block parameters are those whose names begin with `*`."""

    body: XmlElement
    parameters: tuple[str, ...]
    defaults: dict[str, Default] = field(default_factory=dict)

    @property
    def blocks(self) -> tuple[str, ...]:
        """The block parameters, in order."""
        return tuple(name for name in self.parameters if name.startswith("*"))


def read_macro(body: XmlElement) -> Macro:
    """Return what a `<xacro:macro>` defines."""
    names: list[str] = []
    defaults: dict[str, Default] = {}
    text = body.attributes.get("params", "")
    place = 0
    while text[place:].strip():
        match = _DEFAULT.match(text, place) or _PLAIN.match(text, place)
        if match is None:
            break
        names.append(match[1])
        if match.re is _DEFAULT:
            forward = match["forward"] is not None
            if match["default"] or forward:
                defaults[match[1]] = Default(text=match["default"] or None, forward=forward)
        place = match.end()
    return Macro(body=body, parameters=tuple(names), defaults=defaults)

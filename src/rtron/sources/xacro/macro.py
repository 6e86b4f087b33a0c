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
class ParameterDefault:
    """A parameter's default: the caller's property of the same name (`is_forwarded`), or a text."""

    text: str | None
    is_forwarded: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class XacroMacro:
    """A macro; its block parameters are those whose names begin with `*`."""

    body: XmlElement
    parameters: tuple[str, ...]
    defaults: dict[str, ParameterDefault] = field(default_factory=dict)

    @property
    def blocks(self) -> tuple[str, ...]:
        """The block parameters, in order."""
        return tuple(name for name in self.parameters if name.startswith("*"))


def read_macro(body: XmlElement) -> XacroMacro:
    """Return what a `<xacro:macro>` defines."""
    names: list[str] = []
    defaults: dict[str, ParameterDefault] = {}
    text = body.attributes.get("params", "")
    position = 0
    while text[position:].strip():
        match = _DEFAULT.match(text, position) or _PLAIN.match(text, position)
        if match is None:
            break
        names.append(match[1])
        if match.re is _DEFAULT:
            forward = match["forward"] is not None
            if match["default"] or forward:
                defaults[match[1]] = ParameterDefault(
                    text=match["default"] or None, is_forwarded=forward
                )
        position = match.end()
    return XacroMacro(body=body, parameters=tuple(names), defaults=defaults)

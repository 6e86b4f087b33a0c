"""An element of a launch file where it stands: its attributes, evaluated, and whether it counts."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NoReturn

from rtron.errors import InputError
from rtron.sources.launch.common.xml_document import Element, line_of
from rtron.sources.launch.ros1.substitution_args import Substitution

_BOOLEANS = {"true": True, "1": True, "false": False, "0": False}


@dataclass(frozen=True, slots=True, kw_only=True)
class Tag:
    """One element of the file `path`; `substitution` knows the arguments in force there.

    Everything that evaluates raises InputError (the file is wrong), MissingArgumentError or
    UnresolvableError (the surroundings lack something).
    """

    element: Element
    path: str
    substitution: Substitution

    @property
    def name(self) -> str:
        """The element's name."""
        return str(self.element.tag)

    @property
    def line(self) -> int:
        """The element's line, from 1."""
        return line_of(self.element)

    def children(self) -> Iterator["Tag"]:
        """Yield the elements within, comments left out."""
        for child in self.element.iterchildren("*"):
            yield Tag(element=child, path=self.path, substitution=self.substitution)

    def optional(self, attribute: str) -> str | None:
        """Return an attribute's value, or None where it is not written."""
        text = self.element.get(attribute)
        if not text:
            return text
        try:
            return self.substitution.replace(str(text))
        except ValueError as error:
            self.fault(f"{attribute}: {error}")

    def required(self, attribute: str) -> str:
        """Return an attribute's value; raise InputError where it is not written or empty."""
        value = self.optional(attribute)
        if not value:
            self.fault(f"has no '{attribute}'")
        return value

    def flag(self, attribute: str) -> bool | None:
        """Return an attribute that says true or false, None where it is not written."""
        value = self.optional(attribute)
        if value is None:
            return None
        if value.strip().lower() not in _BOOLEANS:
            self.fault(f"{attribute}: '{value}' is neither true nor false")
        return _BOOLEANS[value.strip().lower()]

    def boolean(self, attribute: str) -> bool:
        """Return an attribute that roslaunch takes only as `true` or `false`; false by default."""
        value = self.optional(attribute)
        if value is None:
            return False
        if value.lower() not in {"true", "false"}:
            self.fault(f"{attribute}: '{value}' is neither true nor false")
        return value.lower() == "true"

    def clears(self) -> bool:
        """Tell what `clear_params` says; empty counts as not written."""
        return bool(self.optional("clear_params")) and self.boolean("clear_params")

    def text(self) -> str:
        """Return the text between the element's start and end, other elements left out."""
        pieces = [self.element.text, *(child.tail for child in self.element)]
        return "".join(str(piece) for piece in pieces if piece)

    def applies(self) -> bool:
        """Tell what `if` and `unless` say."""
        wanted, unwanted = self.flag("if"), self.flag("unless")
        if wanted is not None and unwanted is not None:
            self.fault("has both 'if' and 'unless'")
        return not unwanted if wanted is None else wanted

    def fault(self, why: str) -> NoReturn:
        """Raise InputError at this element."""
        raise InputError(f"<{self.name}> {why}", path=self.path, line=self.line)

"""An element of a launch file where it stands: its attributes, evaluated, and whether it counts."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NoReturn

from rtron.errors import InputError
from rtron.sources.launch.common.xml_document import Element, line_of
from rtron.sources.launch.ros1.substitution_args import SubstitutionArgs

_BOOLEANS = {"true": True, "1": True, "false": False, "0": False}


@dataclass(frozen=True, slots=True, kw_only=True)
class Tag:
    """One element of the file `path`; `substitution` knows the arguments in force there.

    Everything that evaluates raises InputError (the file is wrong), MissingArgumentError or
    UnresolvableError (the surroundings lack something).
    """

    element: Element
    path: str
    substitution: SubstitutionArgs

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
            self.fail(f"{attribute}: {error}")

    def required(self, attribute: str) -> str:
        """Return an attribute's value; raise InputError where it is not written or empty."""
        value = self.optional(attribute)
        if not value:
            self.fail(f"has no '{attribute}'")
        return value

    def flag(self, attribute: str) -> bool | None:
        """Return an attribute that says true or false, None where it is not written."""
        value = self.optional(attribute)
        if value is None:
            return None
        if value.strip().lower() not in _BOOLEANS:
            self.fail(f"{attribute}: '{value}' is neither true nor false")
        return _BOOLEANS[value.strip().lower()]

    def boolean(self, attribute: str) -> bool:
        """Return an attribute that roslaunch takes only as `true` or `false`; false by default."""
        value = self.optional(attribute)
        if value is None:
            return False
        if value.lower() not in {"true", "false"}:
            self.fail(f"{attribute}: '{value}' is neither true nor false")
        return value.lower() == "true"

    def clears_parameters(self) -> bool:
        """Tell what `clear_params` says; empty counts as not written."""
        return bool(self.optional("clear_params")) and self.boolean("clear_params")

    def text(self) -> str:
        """Return the text between the element's start and end, other elements left out."""
        texts = [self.element.text, *(child.tail for child in self.element)]
        return "".join(str(piece) for piece in texts if piece)

    def applies(self) -> bool:
        """Tell what `if` and `unless` say."""
        if_value, unless_value = self.flag("if"), self.flag("unless")
        if if_value is not None and unless_value is not None:
            self.fail("has both 'if' and 'unless'")
        return not unless_value if if_value is None else if_value

    def fail(self, why: str) -> NoReturn:
        """Raise InputError at this element."""
        raise InputError(f"<{self.name}> {why}", path=self.path, line=self.line)

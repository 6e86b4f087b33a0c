"""Keeps what of a launch could not be resolved, while the rest of it is read."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from rtron.errors import InputError
from rtron.sources.launch.common.errors import MissingArgumentError, UnresolvableError
from rtron.sources.launch.ros1.loader_context import Scope
from rtron.sources.launch.ros1.tag import Tag
from rtron.vocabulary import Evidence, Unresolved

_SHOWN_BY = ("file", "name", "test-name", "from", "ns")


@dataclass(slots=True)
class Notes:
    """The Unresolved of one launch, in the order in which they were met."""

    unresolved: list[Unresolved] = field(default_factory=list)

    @contextmanager
    def noting(self, tag: Tag) -> Iterator[None]:
        """Note what turns out to be unresolvable at an element, and leave it at that.

        A ValueError becomes the InputError of the element.
        """
        try:
            yield
        except UnresolvableError as error:
            self.add(tag, str(error))
        except ValueError as error:
            tag.fault(str(error))

    def counted(self, tag: Tag, scope: Scope) -> Scope | None:
        """Return the scope in which an element is read, None where its condition is false.

        Where the condition is not known the element is read too, as it may well count, and the
        scope says so.
        """
        try:
            return scope if tag.applies() else None
        except UnresolvableError as error:
            self.add(tag, f"whether it counts is not known, it is read as if it did: {error}")
            return scope.doubted()

    @contextmanager
    def noting_include(self, tag: Tag) -> Iterator[None]:
        """Note what is wrong with the file that an `<include>` names, and leave it at that."""
        try:
            yield
        except InputError as error:
            self.add_error(tag, error)
        except MissingArgumentError as error:
            self.add(tag, f"the included file needs argument '{error.name}'")

    def text(self, tag: Tag, attribute: str) -> str:
        """Return an attribute's value, or its text as it stands where that cannot be resolved."""
        with self.noting(tag):
            return tag.optional(attribute) or ""
        return str(tag.element.get(attribute))

    def add_error(self, tag: Tag, error: InputError) -> None:
        """Note what is wrong with a file that an element names, and where in it."""
        place = [Evidence(file=error.path, line=error.line)] if error.path else []
        self.add(tag, str(error), *place)

    def add(self, tag: Tag, why: str, *evidence: Evidence) -> None:
        """Note that an element is not resolved, and why; further evidence comes after its own."""
        shown = (tag.element.get(attribute) for attribute in _SHOWN_BY)
        what = " ".join((tag.name, *(str(text) for text in list(filter(None, shown))[:1])))
        own = Evidence(file=tag.path, line=tag.line)
        self.unresolved.append(Unresolved(what=what, why=why, evidence=(own, *evidence)))

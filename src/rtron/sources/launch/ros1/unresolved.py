"""Keeps what of a launch could not be resolved, while the rest of it is read."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

from rtron.errors import InputError
from rtron.sources.launch.common.errors import MissingArgumentError, UnresolvableError, missing_file
from rtron.sources.launch.common.packages import package_of
from rtron.sources.launch.ros1.loader_context import LoaderContext, Tag
from rtron.sources.models.packages import known_package_of
from rtron.vocabulary import Evidence, UnresolvedCause, UnresolvedItem
from rtron.vocabulary.enums import HiddenPart

_NAMING_ATTRIBUTES = ("file", "name", "test-name", "from", "ns")


@dataclass(slots=True)
class UnresolvedNotes:
    """The Unresolved of one launch, in the order in which they were met."""

    unresolved: list[UnresolvedItem] = field(default_factory=list)

    @contextmanager
    def collect_errors(self, tag: Tag) -> Iterator[None]:
        """Note what turns out to be unresolvable at an element, and leave it at that.

        A ValueError becomes the InputError of the element.
        """
        try:
            yield
        except UnresolvableError as error:
            self.add(tag, str(error), package=error.package)
        except ValueError as error:
            tag.fail(str(error))

    def context_if_applies(self, tag: Tag, context: LoaderContext) -> LoaderContext | None:
        """Return the scope in which an element is read, None where its condition is false.

        Where the condition is not known the element is read too, as it may well count, and the
        scope says so.
        """
        try:
            return context if tag.applies() else None
        except UnresolvableError as error:
            self.add(tag, f"whether it counts is not known, it is read as if it did: {error}")
            return context.uncertain()

    @contextmanager
    def collect_include_errors(self, tag: Tag) -> Iterator[None]:
        """Note what is wrong with the file that an `<include>` names, and leave it at that."""
        try:
            yield
        except InputError as error:
            missing = missing_file(error)
            if missing and (package := known_package_of(missing)):
                self.add(tag, f"package '{package}' is not found", package=package)
                return
            self.add_error(tag, error, missing)
        except MissingArgumentError as error:
            self.add(tag, f"the included file needs argument '{error.name}'")

    def text(self, tag: Tag, attribute: str) -> str:
        """Return an attribute's value, or its text as it stands where that cannot be resolved."""
        with self.collect_errors(tag):
            return tag.optional(attribute) or ""
        return str(tag.element.get(attribute))

    def add_error(self, tag: Tag, error: InputError, missing: str = "") -> None:
        """Note what is wrong with a file that an element names, and the file that is not there."""
        locations = [Evidence(file=error.path, line=error.line)] if error.path else []
        self.add(tag, str(error), *locations)
        note = replace(self.unresolved[-1], missing=missing, package=package_of(missing))
        self.unresolved[-1] = note

    def add(self, tag: Tag, why: str, *evidence: Evidence, package: str = "") -> None:
        """Note that an element is not resolved, and why; further evidence comes after its own."""
        texts = (tag.element.get(attribute) for attribute in _NAMING_ATTRIBUTES)
        what = " ".join((tag.name, *(str(text) for text in list(filter(None, texts))[:1])))
        places = (Evidence(file=tag.path, line=tag.line), *evidence)
        hides = HiddenPart.NODES if tag.name == "include" else None
        cause = UnresolvedCause.MISSING_SOURCE if package else None
        note = UnresolvedItem(what=what, why=why, package=package, hides=hides, cause=cause)
        self.unresolved.append(replace(note, evidence=places))

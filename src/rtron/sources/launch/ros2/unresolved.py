"""Notes what of a launch has no value before it runs, or cannot be read."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from rtron.errors import InputError
from rtron.sources.launch.common.errors import (
    MissingArgumentError,
    UnresolvableError,
    missing_file,
    missing_parameter_file,
)
from rtron.sources.launch.common.packages import package_of
from rtron.sources.launch.ros2.element_site import ElementSite
from rtron.sources.launch.ros2.limits import LaunchTooLargeError
from rtron.sources.launch.ros2.substitutions.template import (
    UnknownPartError,
    display_text,
    first_placeholder,
)
from rtron.vocabulary import UnresolvedCause, UnresolvedItem, WiringFact, WiringFactKind
from rtron.vocabulary.enums import HiddenPart

_STARTING_TAGS = ("include", "composable_node")
_HARMLESS = (
    UnresolvedCause.ARGUMENT,
    UnresolvedCause.MISSING_SOURCE,
    UnresolvedCause.UNSET_VARIABLE,
)
"""Why values are not known in a launch of which all actions are."""


@dataclass(slots=True, kw_only=True)
class UnresolvedNotes:
    """The notes on one launch; where it is `symbolic`, each is made once and nothing is refused."""

    symbolic: bool = False
    unresolved: list[UnresolvedItem] = field(default_factory=list)
    _noted: set[UnresolvedItem] = field(default_factory=set)
    _missing_arguments: dict[str, WiringFact | None] = field(default_factory=dict)

    def note(
        self,
        site: ElementSite,
        why: str,
        missing: str = "",
        hides: HiddenPart | None = None,
        package: str = "",
        cause: UnresolvedCause | None = None,
    ) -> None:
        """Note what cannot be read of an element, and the file that it names and is not there."""
        keys = ("file", "cmd", "name") if self.symbolic else ("file", "cmd")
        text = next(filter(None, map(site.plain_text, keys)), "")
        what = f"{site.tag} {display_text(text)[:80]}".strip()
        package = package or first_placeholder(text + why).partition("find-pkg-share ")[2]
        entry = UnresolvedItem(
            what=what,
            why=display_text(why),
            missing=missing,
            package=package or package_of(missing),
            hides=HiddenPart.NODES if site.tag in _STARTING_TAGS else hides,
            cause=UnresolvedCause.MISSING_SOURCE if package else cause,
            evidence=(site.location,),
        )
        if not self.symbolic or entry not in self._noted:
            self._noted.add(entry)
            self.unresolved.append(entry)

    @contextmanager
    def collect_errors(self, site: ElementSite) -> Iterator[None]:
        """Note what has no value here, or a file that cannot be read; go on with the rest."""
        try:
            yield
        except LaunchTooLargeError:
            raise
        except UnknownPartError as error:
            if not self.symbolic:
                self.note(site, str(error))
        except InputError as error:
            find_missing = missing_file if site.tag == "include" else missing_parameter_file
            self.note(site, str(error), find_missing(error))
        except UnresolvableError as error:
            self.note(site, str(error), package=error.package)
        except MissingArgumentError as error:
            if site.file.depth == 0 and site.tag != "include" and not self.symbolic:
                raise
            self.note(site, str(error))
        except (ValueError, LookupError) as error:
            if not self.symbolic:
                line = site.element.line
                raise InputError(str(error), path=site.file.path, line=line) from None
            self.note(site, f"launch would refuse it: {error}")

    def note_missing(self, site: ElementSite, name: str) -> None:
        """Note that an argument is not given, once; launch ends where it certainly counts.

        What the first file declares without a default is for the user to give.
        """
        if name not in self._missing_arguments:
            why = f"argument '{name}' is not given"
            self.note(site, why, cause=UnresolvedCause.ARGUMENT)
            self._missing_arguments[name] = None
        is_of_user = site.file.depth == 0 and site.tag == "arg"
        if not (self._missing_arguments[name] or site.context.is_uncertain or is_of_user):
            kind, places = WiringFactKind.MISSING_ARGUMENT, (site.location,)
            fact = WiringFact(kind=kind, subject=name, value=site.file.path, evidence=places)
            self._missing_arguments[name] = fact

    def missing_arguments(self) -> Iterator[WiringFact]:
        """Yield the facts about arguments; none where what was not read may set or not use them."""
        if all(note.cause in _HARMLESS for note in self.unresolved):
            yield from filter(None, self._missing_arguments.values())

    def note_error(self, site: ElementSite, error: Exception) -> None:
        """Note why a call has no value, unless that is noted already, or with its include."""
        if isinstance(error, MissingArgumentError):
            self.note_missing(site, error.name)
        elif not isinstance(error, UnknownPartError):
            package = getattr(error, "package", "")
            if not (package and site.tag == "include"):
                self.note(site, str(error), package=package)

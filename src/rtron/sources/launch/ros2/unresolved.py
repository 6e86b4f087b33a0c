"""Notes what of a launch has no value before it runs, or cannot be read."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from rtron.errors import InputError
from rtron.sources.launch.common.errors import MissingArgumentError, UnresolvableError
from rtron.sources.launch.ros2.inclusion import Place, evidence_of
from rtron.sources.launch.ros2.limits import TooMuchError
from rtron.sources.launch.ros2.substitutions.functions import OpenError
from rtron.sources.launch.ros2.substitutions.template import shown
from rtron.sources.launch.ros2.xml_yaml.element import Element
from rtron.vocabulary import Unresolved


@dataclass(slots=True, kw_only=True)
class Notes:
    """The notes on one launch; where it is `symbolic`, each is made once and nothing is refused."""

    symbolic: bool = False
    unresolved: list[Unresolved] = field(default_factory=list)
    _noted: set[Unresolved] = field(default_factory=set)
    _missing: set[str] = field(default_factory=set)

    def note(self, element: Element, place: Place, why: str) -> None:
        """Note what cannot be read of an element."""
        keys = ("file", "cmd", "name") if self.symbolic else ("file", "cmd")
        text = next(filter(None, map(element.plain, keys)), "")
        own = evidence_of(element, place)
        what = f"{element.tag} {shown(text)[:80]}".strip()
        noted = Unresolved(what=what, why=shown(why), evidence=(own,))
        if not self.symbolic or noted not in self._noted:
            self._noted.add(noted)
            self.unresolved.append(noted)

    @contextmanager
    def noting(self, element: Element, place: Place) -> Iterator[None]:
        """Note what has no value here, or a file that cannot be read; go on with the rest."""
        try:
            yield
        except TooMuchError:
            raise
        except OpenError as error:
            if not self.symbolic:
                self.note(element, place, str(error))
        except (UnresolvableError, InputError) as error:
            self.note(element, place, str(error))
        except MissingArgumentError as error:
            if place.depth == 0 and element.tag != "include" and not self.symbolic:
                raise
            self.note(element, place, str(error))
        except (ValueError, LookupError) as error:
            if not self.symbolic:
                raise InputError(str(error), path=place.path, line=element.line) from None
            self.note(element, place, f"launch would refuse it: {error}")

    def note_missing(self, element: Element, place: Place, name: str) -> None:
        """Note that an argument is not given, once."""
        if name not in self._missing:
            self.note(element, place, f"argument '{name}' is not given")
        self._missing.add(name)

    def note_failed(self, element: Element, place: Place, error: Exception) -> None:
        """Note why a call has no value, unless that follows from what is noted already."""
        if isinstance(error, MissingArgumentError):
            self.note_missing(element, place, error.name)
        elif not isinstance(error, OpenError):
            self.note(element, place, str(error))

"""The texts of a ROS 2 launch file evaluated: attributes, conditions, remaps and configurations."""

import os.path
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import is_there
from rtron.sources.launch.unresolvable import MissingArgumentError, UnresolvableError
from rtron.sources.launch2.bounds import Bounds, TooMuchError
from rtron.sources.launch2.choices import Choices
from rtron.sources.launch2.element import Element
from rtron.sources.launch2.place import Place
from rtron.sources.launch2.scope import Scope, Source
from rtron.sources.launch2.substitution import (
    Function,
    Substitution,
    environment,
    truth,
    variable,
)
from rtron.vocabulary import Evidence, Unresolved
from rtron.vocabulary.remap_rules import UNKNOWN, Rule


@dataclass(slots=True, kw_only=True)
class Evaluator:
    """Evaluates what stands in elements, and notes what has no value before the launch runs.

    `touched` are the arguments and variables that decided what was evaluated last.
    """

    environ: Mapping[str, str]
    packages: Mapping[str, Path]
    choices: Choices
    bounds: Bounds = field(default_factory=Bounds)
    unresolved: list[Unresolved] = field(default_factory=list)
    touched: set[Source] = field(default_factory=set)

    def text(self, element: Element, key: str, scope: Scope, place: Place) -> str | None:
        """Return an attribute's value as `value` does; it decides what starts, or a name."""
        value = self.value(element, key, scope, place)
        self.choices.decide(self.touched)
        return value

    def value(self, element: Element, key: str, scope: Scope, place: Place) -> str | None:
        """Return an attribute's value; None where it is not written, or, noted, has none here.

        Afterwards `touched` has the arguments and variables that decide it.
        """
        self.touched = set()
        written = element.attributes.get(key)
        if written is None:
            return None
        with self.noting(element, place):
            return self._substitution(scope, place).replace(written)
        return None

    def condition(
        self, element: Element, scope: Scope, place: Place
    ) -> tuple[bool | None, frozenset[Source]]:
        """Return what an element's condition says, None if it is not known, and what decides it."""
        said: list[bool | None] = []
        why: set[Source] = set()
        for key, wanted in (("if", True), ("unless", False)):
            if key in element.attributes:
                said.append(None)
                text = self.value(element, key, scope, place)
                why |= self.touched
                with self.noting(element, place):
                    said[-1] = None if text is None else truth(text) is wanted
        known = False if False in said else None if None in said else True
        return known, frozenset(why)

    def pairs(self, elements: Iterable[Element], scope: Scope, place: Place) -> list[Rule]:
        """Return the remap rules that elements say, `*` for a name that is not known."""
        found = []
        for element in elements:
            self.bounds.action(place.path, scope)
            pair = [self.text(element, key, scope, place) for key in ("from", "to")]
            found.append((pair[0] or UNKNOWN, pair[1] or UNKNOWN))
        return found

    def given(
        self, elements: Iterable[Element], scope: Scope, place: Place
    ) -> Iterator[tuple[Source, str | None, frozenset[Source]]]:
        """Yield the configurations that elements set, and what decides their values."""
        for element in elements:
            name = self.text(element, "name", scope, place)
            value = self.value(element, "value", scope, place)
            if name is not None:
                yield Source(name), value, frozenset(self.touched)

    def note(self, element: Element, place: Place, why: str) -> None:
        """Note what cannot be read of an element."""
        named = element.attributes.get("file") or element.attributes.get("cmd") or ""
        own = Evidence(file=place.path, line=element.line)
        what = f"{element.tag} {named[:80]}".strip()
        self.unresolved.append(Unresolved(what=what, why=why, evidence=(own,)))

    @contextmanager
    def noting(self, element: Element, place: Place) -> Iterator[None]:
        """Note what has no value here, or a file that cannot be read; go on with the rest."""
        try:
            yield
        except TooMuchError:
            raise
        except (UnresolvableError, InputError) as error:
            self.note(element, place, str(error))
        except MissingArgumentError as error:
            if place.depth == 0 and element.tag != "include":
                raise
            self.note(element, place, str(error))
        except (ValueError, LookupError) as error:
            raise InputError(str(error), path=place.path, line=element.line) from None

    def _substitution(self, scope: Scope, place: Place) -> Substitution:
        folder = os.path.dirname(place.path)  # noqa: PTH120 - a string in a string out

        def looked_up(function: Function, words: list[str], *, environment: bool = False) -> str:
            source = Source("".join(words[:1]), environment)
            self.touched |= scope.behind(source)
            if source in scope.unknown:
                raise UnresolvableError(f"the value of '{source.name}' is not known")
            return function(words)

        value, variable_value = variable(scope.configurations), environment(scope.environ)
        return Substitution(
            {
                "var": lambda words: looked_up(value, words),
                "env": lambda words: looked_up(variable_value, words, environment=True),
                "dirname": lambda _: folder,
                "filename": lambda _: place.path,
                "anon": lambda words: f"{words[0]}_{UNKNOWN}",
                "find-pkg-share": self._share,
                "find-pkg-prefix": self._prefix,
            }
        )

    def _share(self, words: list[str]) -> str:
        name = "".join(words[:1])
        if name in self.packages:
            return str(self.packages[name])
        for prefix in filter(None, self.environ.get("AMENT_PREFIX_PATH", "").split(":")):
            share = Path(prefix) / "share" / name
            if is_there(share) and share.is_dir():
                return str(share)
        raise UnresolvableError(f"package '{name}' is not here")

    def _prefix(self, words: list[str]) -> str:
        return str(Path(self._share(words)).parents[1])

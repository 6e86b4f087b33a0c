"""The texts of a ROS 2 launch file evaluated: attributes, conditions, remaps and configurations."""

import os.path
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from rtron.errors import InputError
from rtron.folders import is_there
from rtron.sources.launch.unresolvable import MissingArgumentError, UnresolvableError
from rtron.sources.launch2.bounds import Bounds, TooMuchError
from rtron.sources.launch2.choices import Choices
from rtron.sources.launch2.element import Element
from rtron.sources.launch2.functions import Function, OpenError, closed, said, truth
from rtron.sources.launch2.pieces import hole, shown
from rtron.sources.launch2.place import Place, evidence_of
from rtron.sources.launch2.scope import Scope, Source
from rtron.sources.launch2.substitution import MAX_LONG, Substitution, environment, variable
from rtron.sources.launch2.view import View
from rtron.sources.launch2.yaml_files import YamlFiles
from rtron.vocabulary import Unresolved
from rtron.vocabulary.remap_rules import UNKNOWN, Rule


@dataclass(slots=True, kw_only=True)
class Evaluator:
    """Evaluates what stands in elements, and notes what has no value before the launch runs.

    `touched` are the arguments and variables that decided what was evaluated last. Where it is
    `symbolic`, a text keeps what is known of it: the rest are holes (`pieces`), each noted once.
    """

    environ: Mapping[str, str]
    packages: Mapping[str, Path]
    choices: Choices
    symbolic: bool = False
    files: YamlFiles = field(default_factory=YamlFiles)
    bounds: Bounds = field(default_factory=Bounds)
    unresolved: list[Unresolved] = field(default_factory=list)
    touched: set[Source] = field(default_factory=set)
    _noted: set[Unresolved] = field(default_factory=set)
    _missing: set[str] = field(default_factory=set)

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
            return self.substitution(element, scope, place).replace(written)
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

    def substitution(self, element: Element, scope: Scope, place: Place) -> Substitution:
        """Return what replaces substitutions in an element's texts."""
        functions = self._functions(scope, place)
        if not self.symbolic:
            return Substitution(functions)

        def failed(what: str, error: Exception) -> str:
            self._note_failed(element, place, error)
            return hole(what)

        found = Substitution(functions, failed, most=MAX_LONG)
        note = partial(self.note, element, place)
        found.view = View(perform=found.replace, scope=scope, note=note, files=self.files)
        return found

    def note_missing(self, element: Element, place: Place, name: str) -> None:
        """Note that an argument is not given, once."""
        if name not in self._missing:
            self.note(element, place, f"argument '{name}' is not given")
        self._missing.add(name)

    def _note_failed(self, element: Element, place: Place, error: Exception) -> None:
        """Note why a call has no value, unless that follows from what is noted already."""
        if isinstance(error, MissingArgumentError):
            self.note_missing(element, place, error.name)
        elif not isinstance(error, OpenError):
            self.note(element, place, str(error))

    def view(self, element: Element, scope: Scope, place: Place) -> View:
        """Return what a function of a Python launch file sees of the launch."""
        note = partial(self.note, element, place)
        replace = self.substitution(element, scope, place).replace
        return View(perform=replace, scope=scope, note=note, files=self.files)

    def _functions(self, scope: Scope, place: Place) -> Mapping[str, Function]:
        folder = os.path.dirname(place.path)  # noqa: PTH120 - a string in a string out

        def looked_up(function: Function, words: list[str], *, environment: bool = False) -> str:
            source = Source("".join(words[:1]), environment)
            self.touched |= scope.behind(source)
            if source in scope.unknown:
                raise UnresolvableError(f"the value of '{source.name}' is not known")
            return function(words)

        value, variable_value = variable(scope.configurations), environment(scope.environ)
        return {
            "var": lambda words: looked_up(value, words),
            "env": lambda words: looked_up(variable_value, words, environment=True),
            "optenv": lambda words: looked_up(variable_value, [*words, ""][:2], environment=True),
            "dirname": lambda _: folder,
            "filename": lambda _: place.path,
            "anon": lambda words: f"{words[0]}_{UNKNOWN}",
            "config-equals": lambda words: said(
                scope.configurations.get(words[0]) == closed("".join(words[1:]))
            ),
            "find-pkg-share": self._share,
            "find-pkg-prefix": self._prefix,
            "exec-in-pkg": lambda words: f"{self._prefix(words[1:])}/lib/{words[1]}/{words[0]}",
            "find-exec": lambda words: words[0],
            "node-name": lambda words: scope.full_name(*words),
            "command": self._command,
        }

    def _command(self, words: list[str]) -> str:
        raise UnresolvableError(f"$(command {shown(words[0])[:80]}) is not run")

    def _share(self, words: list[str]) -> str:
        name = closed("".join(words[:1]))
        if name in self.packages:
            return str(self.packages[name])
        for prefix in filter(None, self.environ.get("AMENT_PREFIX_PATH", "").split(":")):
            share = Path(prefix) / "share" / name
            if is_there(share) and share.is_dir():
                return str(share)
        raise UnresolvableError(f"package '{name}' is not here")

    def _prefix(self, words: list[str]) -> str:
        if self.symbolic and "".join(words[:1]) in self.packages:
            raise UnresolvableError(f"where '{words[0]}' is installed is not known before a build")
        return str(Path(self._share(words)).parents[1])

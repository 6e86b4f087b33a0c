"""The texts of a ROS 2 launch file evaluated: attributes, conditions, remaps and configurations."""

import os.path
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.ros2.choices import Choices
from rtron.sources.launch.ros2.context_view import View
from rtron.sources.launch.ros2.inclusion import Place
from rtron.sources.launch.ros2.launch_context import Scope, Source
from rtron.sources.launch.ros2.limits import Bounds
from rtron.sources.launch.ros2.parameters.file_cache import YamlFiles
from rtron.sources.launch.ros2.parameters.merge import ALL
from rtron.sources.launch.ros2.substitutions.command_output import Commands
from rtron.sources.launch.ros2.substitutions.functions import Function, closed, given, said, truth
from rtron.sources.launch.ros2.substitutions.loops import loop_variable
from rtron.sources.launch.ros2.substitutions.package_lookup import Lookups
from rtron.sources.launch.ros2.substitutions.substitution import (
    MAX_LONG,
    Substitution,
    environment,
    variable,
)
from rtron.sources.launch.ros2.substitutions.template import hole
from rtron.sources.launch.ros2.unresolved import Notes
from rtron.sources.launch.ros2.xml_yaml.element import Element
from rtron.vocabulary import UnknownValue
from rtron.vocabulary.remap_rules import UNKNOWN, Rule


@dataclass(slots=True, kw_only=True)
class Evaluator(Notes):
    """Evaluates what stands in elements, and notes what has no value before the launch runs.

    `touched` are the arguments and variables that decided what was evaluated last. Where it is
    `symbolic`, a text keeps what is known of it: the rest are holes (`pieces`), each noted once.
    """

    environ: Mapping[str, str]
    packages: Mapping[str, Path]
    choices: Choices
    installed: Callable[[str], str] = str
    files: YamlFiles = field(init=False)
    commands: Commands = field(init=False)
    bounds: Bounds = field(default_factory=Bounds)
    touched: set[Source] = field(default_factory=set)

    def __post_init__(self) -> None:
        """Let the files count in the same bounds, and commands make notes."""
        self.files = YamlFiles(self.bounds, self.installed)
        self.commands = Commands(
            packages=self.packages,
            environ=self.environ,
            installed=self.installed,
            notes=self.unresolved,
        )

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

    def substitution(self, element: Element, scope: Scope, place: Place) -> Substitution:
        """Return what replaces substitutions in an element's texts."""
        functions = self._functions(scope, place)
        if not self.symbolic:
            return Substitution(functions)

        def failed(what: str, error: Exception) -> str:
            self.note_failed(element, place, error)
            return hole(what)

        found = Substitution(functions, failed, most=MAX_LONG)
        found.view = self._view(element, scope, place, found)
        return found

    def view(self, element: Element, scope: Scope, place: Place) -> View:
        """Return what a function of a Python launch file sees of the launch."""
        return self._view(element, scope, place, self.substitution(element, scope, place))

    def _view(
        self, element: Element, scope: Scope, place: Place, substitution: Substitution
    ) -> View:
        note = partial(self.note, element, place)
        return View(perform=substitution.replace, scope=scope, note=note, files=self.files)

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
            "config-equals": partial(_is_set_to, scope),
            "for-var": loop_variable(scope.loops),
            "index": loop_variable(scope.loops),
            "param": partial(_shared, scope),
            "node-name": lambda words: scope.full_name(*words),
            **Lookups(self.environ, self.packages, self.symbolic, self.commands).functions(),
        }


def _shared(scope: Scope, words: list[str]) -> str:
    """Return a parameter for all nodes, the first of its name (launch_ros: Parameter)."""
    name, *default = given(words, 1, 2)
    entries = (entry for source in scope.parameters or () for entry in source.entries)
    for pattern, values in entries:
        if pattern == ALL and name in values:
            value = values[name].value
            if isinstance(value, UnknownValue):
                raise UnresolvableError(value.why)
            return str(value)
    if not default:
        raise UnresolvableError(f"no parameter '{name}' is set for all nodes")
    return default[0]


def _is_set_to(scope: Scope, words: list[str]) -> str:
    """Return whether a configuration is set to a value; one that is not set is set to nothing."""
    value = scope.configurations.get(words[0], "")
    return said(closed(value) == closed("".join(words[1:])))

"""What a launch depends on: arguments and variables that decide names, files and what starts."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from rtron.sources.launch.ros2.launch_context import LaunchVariable
from rtron.sources.launch.ros2.xml_yaml.element import Element
from rtron.vocabulary import LaunchInput
from rtron.vocabulary.remap_rules import UNKNOWN_NAME


@dataclass(slots=True, kw_only=True)
class LaunchChoices:
    """Collects the sources of what was read; `arguments` and `environ` are those at the start.

    `declared` has a `*` where something was not read that may declare more arguments.
    """

    arguments: Mapping[str, str]
    environ: Mapping[str, str]
    _deciding: set[LaunchVariable] = field(default_factory=set)
    declared: set[str] = field(default_factory=set)
    _defaults: dict[str, set[str | None]] = field(default_factory=dict)

    def decide(self, variables: Iterable[LaunchVariable]) -> None:
        """Take note that the sources decide what starts, or a name, or a file."""
        self._deciding.update(variables)

    def skip(self, element: Element) -> None:
        """Take note of an action that does not run: what is declared in it is declared."""
        if element.tag == "arg":
            self.declared.add(element.plain_text("name"))
        elif element.tag == "include" or element.expand is not None:
            self.declared.add(UNKNOWN_NAME)
        else:
            for child in element.children:
                self.skip(child)

    def add_default(self, name: str, value: str | None) -> None:
        """Take note of what an argument is if it is not given; None for an unknown value."""
        self._defaults.setdefault(name, set()).add(value)

    def all(self) -> tuple[LaunchInput, ...]:
        """Return all that was decided."""
        return tuple(
            LaunchInput(name=s.name, values=self._values(s), environment=s.is_environment)
            for s in sorted(self._deciding)
        )

    def _values(self, variable: LaunchVariable) -> tuple[str | None, ...]:
        """Return the values that change nothing: to give an argument its default does not."""
        if variable.is_environment:
            return (self.environ.get(variable.name),)
        if variable.name in self.arguments:
            return (self.arguments[variable.name],)
        defaults = self._defaults.get(variable.name, set())
        return (None, *(defaults - {None} if len(defaults) == 1 else ()))

"""What a launch depends on: arguments and variables that decide names, files and what starts."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from rtron.sources.launch.ros2.launch_context import Source
from rtron.vocabulary import LaunchChoice


@dataclass(slots=True, kw_only=True)
class Choices:
    """Collects the sources of what was read; `arguments` and `environ` are those at the start."""

    arguments: Mapping[str, str]
    environ: Mapping[str, str]
    _decided: set[Source] = field(default_factory=set)
    _defaults: dict[str, set[str | None]] = field(default_factory=dict)

    def decide(self, sources: Iterable[Source]) -> None:
        """Take note that the sources decide what starts, or a name, or a file."""
        self._decided.update(sources)

    def default(self, name: str, value: str | None) -> None:
        """Take note of what an argument is if it is not given; None for an unknown value."""
        self._defaults.setdefault(name, set()).add(value)

    def all(self) -> tuple[LaunchChoice, ...]:
        """Return all that was decided."""
        return tuple(
            LaunchChoice(name=s.name, values=self._values(s), environment=s.environment)
            for s in sorted(self._decided)
        )

    def _values(self, source: Source) -> tuple[str | None, ...]:
        """Return the values that change nothing: to give an argument its default does not."""
        if source.environment:
            return (self.environ.get(source.name),)
        if source.name in self.arguments:
            return (self.arguments[source.name],)
        defaults = self._defaults.get(source.name, set())
        return (None, *(defaults - {None} if len(defaults) == 1 else ()))

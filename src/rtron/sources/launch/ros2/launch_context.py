"""What counts at a place of a ROS 2 launch: configurations, environment and shared remaps."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

from rtron.sources.launch.ros2.parameters.merge import ParameterSource
from rtron.vocabulary.remap_rules import UNKNOWN, Rule

NAMESPACE = "ros_namespace"
"""The configuration in which launch_ros keeps the pushed namespace."""


Mark: TypeAlias = tuple[int, int, int]


class Source(NamedTuple):
    """Something with a value: a configuration, which is an argument too, or a variable."""

    name: str
    environment: bool = False


@dataclass(slots=True)
class Scope:
    """One scope; actions change it for all that comes after them in it.

    `remaps` are those of `set_remap`, in order, None before the first. launch_ros adds to the list
    that it finds, so a group changes that of the scopes around it, if they have one already. So are
    `parameters` those of `set_parameter` and `set_parameters_from_file`.
    `unknown` are those that are set, to what is not known. `sources` tells of each that the
    launch sets itself which arguments and variables decided its value. `loops` are the values of
    the round of each loop around, None for one that is not known.
    """

    configurations: dict[str, str] = field(default_factory=dict)
    environ: dict[str, str] = field(default_factory=dict)
    remaps: list[Rule] | None = None
    parameters: list[ParameterSource] | None = None
    doubtful: bool = False
    unknown: set[Source] = field(default_factory=set)
    sources: dict[Source, frozenset[Source]] = field(default_factory=dict)
    loops: dict[str, str | None] = field(default_factory=dict)
    _puts: list[Source] = field(default_factory=list)
    _clears: int = 0

    @property
    def namespace(self) -> str | None:
        """What was pushed, None before the first; UNKNOWN if that is not known."""
        unknown = Source(NAMESPACE) in self.unknown
        return UNKNOWN if unknown else self.configurations.get(NAMESPACE)

    def put(self, source: Source, value: str | None, sources: Collection[Source] = ()) -> None:
        """Set a configuration or variable; None for a value that only the running launch knows."""
        values = self.environ if source.environment else self.configurations
        values.pop(source.name, None)
        self.unknown.discard(source)
        if value is None:
            self.unknown.add(source)
        else:
            values[source.name] = value
        self.sources[source] = frozenset(sources)
        self._puts.append(source)

    def behind(self, source: Source) -> frozenset[Source]:
        """Return which arguments and variables decide a value here."""
        return self.sources.get(source, frozenset({source}))

    def share(self, rules: Collection[Rule]) -> None:
        """Add remap rules for all nodes, as `set_remap` does."""
        self.remaps = [] if self.remaps is None else self.remaps
        self.remaps += rules

    def share_parameter(self, source: ParameterSource) -> None:
        """Add a parameter, or a file of them, for all nodes."""
        self.parameters = [] if self.parameters is None else self.parameters
        self.parameters.append(source)

    def clear(self) -> None:
        """Forget all configurations, as `reset` does; the namespace and the remaps are such."""
        self._clears += 1
        self.configurations, self.remaps, self.parameters = {}, None, None
        self.unknown = {source for source in self.unknown if source.environment}
        self.sources = {key: why for key, why in self.sources.items() if key.environment}

    @property
    def size(self) -> int:
        """How many configurations and variables there are."""
        return len(self.configurations) + len(self.environ) + len(self.unknown)

    def inner(self) -> "Scope":
        """Return the scope of a group."""
        return Scope(
            configurations=dict(self.configurations),
            environ=dict(self.environ),
            remaps=self.remaps,
            parameters=self.parameters,
            doubtful=self.doubtful,
            unknown=set(self.unknown),
            sources=dict(self.sources),
            loops=self.loops,
        )

    def renew(self, environ: Mapping[str, str]) -> None:
        """Set the environment as it was at the start, as `reset_env` does."""
        self._clears += 1
        self.environ = dict(environ)

    def mark(self) -> Mark:
        """Return what has changed so far, for `depend`."""
        return len(self._puts), self._clears, len(self.remaps or ())

    def depend(self, sources: Collection[Source], since: Mark) -> bool:
        """Note that all that was set since a mark depends on `sources` too.

        Return True if more than values has changed.
        """
        puts, *others = since
        for source in self._puts[puts:] if sources else ():
            self.sources[source] = self.behind(source).union(sources)
        return others != [self._clears, len(self.remaps or ())]

    def space(self, own: str | None) -> str | None:
        """Return the namespace of a node, or what it is after a push; None for no namespace."""
        if own is None:
            known = self.namespace in (None, UNKNOWN)
            return self.namespace if known else canonical(self.namespace or "")
        if own.startswith("/"):
            return canonical(own)
        if UNKNOWN in (own, self.namespace):
            return UNKNOWN
        return canonical(f"{self.namespace or ''}/{own}")

    def full_name(self, name: str, own: str | None = None) -> str:
        """Return a node's full name."""
        space = self.space(own)
        return f"{space or ''}/{name}" if space != "/" else f"/{name}"


def canonical(space: str) -> str:
    """Return a namespace with one slash before each part."""
    return "/" + "/".join(part for part in space.split("/") if part)

"""What counts at a place of a ROS 2 launch: configurations, environment and shared remaps."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

from rtron.sources.launch.ros2.parameters.merge import ParameterSource
from rtron.sources.launch.ros2.substitutions.template import placeholder
from rtron.vocabulary import Evidence
from rtron.vocabulary.remap_rules import UNKNOWN_NAME, RemapRule

NAMESPACE = "ros_namespace"
"""The configuration in which launch_ros keeps the pushed namespace."""


ChangeMark: TypeAlias = tuple[int, int, int]


class LaunchVariable(NamedTuple):
    """Something with a value: a configuration, which is an argument too, or a variable."""

    name: str
    is_environment: bool = False


class ArgumentOrigin(NamedTuple):
    """Where an argument got its value: a default, or what an inclusion gives.

    `file` is the included file it was for, once that is read: the value stays for the next one.
    """

    location: Evidence
    is_default: bool
    file: str = ""


@dataclass(slots=True)
class LaunchContext:
    """One scope; actions change it for all that comes after them in it.

    `remaps` are those of `set_remap`, in order, None before the first. launch_ros adds to the list
    that it finds, so a group changes that of the scopes around it, if they have one already. So are
    `parameters` those of `set_parameter` and `set_parameters_from_file`.
    `unknown` are those that are set, to what is not known. `dependencies` tells of each that the
    launch sets itself which arguments and variables decided its value. `loops` are the values of
    the round of each loop around, None for one that is not known. `origins` are those of arguments.
    """

    configurations: dict[str, str] = field(default_factory=dict)
    environ: dict[str, str] = field(default_factory=dict)
    remaps: list[RemapRule] | None = None
    parameters: list[ParameterSource] | None = None
    is_uncertain: bool = False
    unknown: set[LaunchVariable] = field(default_factory=set)
    dependencies: dict[LaunchVariable, frozenset[LaunchVariable]] = field(default_factory=dict)
    loops: dict[str, str | None] = field(default_factory=dict)
    origins: dict[str, ArgumentOrigin] = field(default_factory=dict)
    _pushed: list["LaunchContext"] = field(default_factory=list)
    _changes: list[LaunchVariable] = field(default_factory=list)
    _reset_count: int = 0

    @property
    def namespace(self) -> str | None:
        """What was pushed, None before the first; UNKNOWN if that is not known."""
        unknown = LaunchVariable(NAMESPACE) in self.unknown
        return UNKNOWN_NAME if unknown else self.configurations.get(NAMESPACE)

    def set_value(
        self,
        variable: LaunchVariable,
        value: str | None,
        dependencies: Collection[LaunchVariable] = (),
    ) -> None:
        """Set a configuration or variable; None for a value that only the running launch knows."""
        values = self.environ if variable.is_environment else self.configurations
        values.pop(variable.name, None)
        self.unknown.discard(variable)
        self.origins.pop(variable.name, None)
        if value is None:
            self.unknown.add(variable)
        else:
            values[variable.name] = value
        self.dependencies[variable] = frozenset(dependencies)
        self._changes.append(variable)

    def dependencies_of(self, variable: LaunchVariable) -> frozenset[LaunchVariable]:
        """Return which arguments and variables decide a value here."""
        return self.dependencies.get(variable, frozenset({variable}))

    def leave_file(self, path: str, before: Mapping[str, ArgumentOrigin]) -> None:
        """Note of what was given or set for an included file that it is read; `before` was not."""
        for name, origin in self.origins.items():
            if not origin.file and before.get(name) != origin:
                self.origins[name] = origin._replace(file=path)

    def add_remaps(self, rules: Collection[RemapRule]) -> None:
        """Add remap rules for all nodes, as `set_remap` does."""
        self.remaps = [] if self.remaps is None else self.remaps
        self.remaps += rules

    def add_parameters(self, source: ParameterSource) -> None:
        """Add a parameter, or a file of them, for all nodes."""
        self.parameters = [] if self.parameters is None else self.parameters
        self.parameters.append(source)

    def clear(self) -> None:
        """Forget all configurations, as `reset` does; the namespace and the remaps are such."""
        self._reset_count += 1
        self.configurations, self.remaps, self.parameters = {}, None, None
        self.unknown = {source for source in self.unknown if source.is_environment}
        self.dependencies = {
            key: dependencies
            for key, dependencies in self.dependencies.items()
            if key.is_environment
        }

    def push_configurations(self) -> None:
        """Keep all configurations for `pop_configurations`."""
        self._pushed.append(self.child())

    def pop_configurations(self) -> None:
        """Set all configurations, the namespace and the remaps among them, as they were pushed."""
        if not self._pushed:
            return
        before = self._pushed.pop()
        self._reset_count += 1
        self.configurations, self.origins = before.configurations, before.origins
        self.remaps, self.parameters = before.remaps, before.parameters
        self.unknown = {
            *(each for each in self.unknown if each.is_environment),
            *(each for each in before.unknown if not each.is_environment),
        }
        self.dependencies = before.dependencies | {
            key: value for key, value in self.dependencies.items() if key.is_environment
        }

    @property
    def size(self) -> int:
        """How many configurations and variables there are."""
        return len(self.configurations) + len(self.environ) + len(self.unknown)

    def child(self) -> "LaunchContext":
        """Return the scope of a group."""
        return LaunchContext(
            configurations=dict(self.configurations),
            environ=dict(self.environ),
            remaps=self.remaps,
            parameters=self.parameters,
            is_uncertain=self.is_uncertain,
            unknown=set(self.unknown),
            dependencies=dict(self.dependencies),
            loops=self.loops,
            origins=dict(self.origins),
        )

    def reset_environment(self, environ: Mapping[str, str]) -> None:
        """Set the environment as it was at the start, as `reset_env` does, or to another one."""
        self._reset_count += 1
        self.environ = dict(environ)
        self.unknown = {source for source in self.unknown if not source.is_environment}

    def change_mark(self) -> ChangeMark:
        """Return what has changed so far, for `add_dependencies`."""
        return len(self._changes), self._reset_count, len(self.remaps or ())

    def forget_changes(self, before: "LaunchContext", *, new: bool) -> None:
        """Let what has another value than in a copy be one of both: not known.

        What had none there keeps its value, unless `new`.
        """
        for name in ("configurations", "environ"):
            values, previous = getattr(self, name), getattr(before, name)
            names = {*previous, *values} if new else set(previous)
            changed = [each for each in names if values.get(each) != previous.get(each)]
            values.update({each: placeholder(each) for each in changed})

    def add_dependencies(self, dependencies: Collection[LaunchVariable], since: ChangeMark) -> bool:
        """Note that all that was set since a mark depends on `dependencies` too.

        Return True if more than values has changed.
        """
        change_count, *other_counts = since
        for source in self._changes[change_count:] if dependencies else ():
            self.dependencies[source] = self.dependencies_of(source).union(dependencies)
        return other_counts != [self._reset_count, len(self.remaps or ())]

    def node_namespace(self, node_namespace_text: str | None) -> str | None:
        """Return the namespace of a node, or what it is after a push; None for no namespace."""
        if node_namespace_text is None:
            is_final = self.namespace in (None, UNKNOWN_NAME)
            return self.namespace if is_final else canonical_namespace(self.namespace or "")
        if node_namespace_text.startswith("/"):
            return canonical_namespace(node_namespace_text)
        if UNKNOWN_NAME in (node_namespace_text, self.namespace):
            return UNKNOWN_NAME
        return canonical_namespace(f"{self.namespace or ''}/{node_namespace_text}")

    def full_name(self, name: str, node_namespace_text: str | None = None) -> str:
        """Return a node's full name."""
        namespace = self.node_namespace(node_namespace_text)
        return f"{namespace or ''}/{name}" if namespace != "/" else f"/{name}"


def canonical_namespace(namespace: str) -> str:
    """Return a namespace with one slash before each part."""
    return "/" + "/".join(part for part in namespace.split("/") if part)

"""What a launch of ROS 2 starts, found without running anything."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from rtron.sources.launch.common.yaml_tree import YamlTree
from rtron.sources.launch.ros2.parameters.merge import (
    ParameterSource,
    merge_component_parameters,
    merge_node_parameters,
)
from rtron.vocabulary import Evidence, StringEnum, UnresolvedItem, WiringFact
from rtron.vocabulary.parameters import Parameter
from rtron.vocabulary.remap_rules import UNKNOWN_NAME, RemapRule


class StartKind(StringEnum):
    """What a launch starts: processes, and components that containers load."""

    NODE = "node"
    LIFECYCLE_NODE = "lifecycle_node"
    CONTAINER = "container"
    COMPONENT = "component"
    PROCESS = "process"


@dataclass(frozen=True, slots=True, kw_only=True)
class LaunchStart:
    """A node, component or process that a launch starts.

    `name` is empty where the program names its node itself; `full_name` then ends in `*`. What is
    not known of a text stands in braces. `has_namespace` says that a namespace is given. `program`
    is an executable, or a component's class, which the node `container` loads. `remaps` are in
    order: the first that fits a name counts. `arguments` are the words of a command line, for a
    process the whole of it. `parameters_complete` says that every parameter file is known,
    `extra_arguments` are a component's extra arguments. `is_uncertain` says that a condition that
    it stands under is not known.
    """

    kind: StartKind
    package: str = ""
    program: str = ""
    name: str = ""
    namespace: str = "/"
    has_namespace: bool = False
    remaps: tuple[RemapRule, ...] = ()
    parameter_sources: tuple[ParameterSource, ...] = ()
    parameters_complete: bool = True
    arguments: tuple[str, ...] = ()
    environ: tuple[tuple[str, str], ...] = ()
    container: str = ""
    extra_arguments: Mapping[str, Parameter] = field(default_factory=dict)
    is_uncertain: bool = False
    evidence: Evidence

    @property
    def full_name(self) -> str:
        """The node's full name."""
        return f"{self.namespace.rstrip('/')}/{self.name or UNKNOWN_NAME}"

    def parameters(self) -> dict[str, Parameter]:
        """Return the parameters that it is given, as `merge_node_parameters` merges them.

        For a component launch_ros takes them together itself, as `merge_component_parameters` says.
        """
        if self.kind is StartKind.COMPONENT:
            return merge_component_parameters(self.parameter_sources, self.full_name)
        return merge_node_parameters(self.parameter_sources, self.full_name)


@dataclass(frozen=True, slots=True, kw_only=True)
class DeclaredArgument:
    """An argument that a launch file declares; `default` is None for one that must be given."""

    name: str
    default: str | None
    evidence: Evidence


@dataclass(frozen=True, slots=True, kw_only=True)
class AppLaunch:
    """What a launch file starts, in the order of starting, with all that it includes.

    `arguments` are those that the file itself declares, `declared` the names of those that all
    files declare or read; `has_includes` says that it includes files; `unresolved` is what could
    not be read, `wiring` what it wires in a way that is hardly meant.
    `generated_files` are the files that exist only while the launch runs, by what they are called.
    """

    file: str
    generated_files: Mapping[str, YamlTree] = field(default_factory=dict)
    starts: tuple[LaunchStart, ...] = ()
    arguments: tuple[DeclaredArgument, ...] = ()
    has_includes: bool = False
    declared: frozenset[str] = frozenset()
    unresolved: tuple[UnresolvedItem, ...] = ()
    wiring: tuple[WiringFact, ...] = ()

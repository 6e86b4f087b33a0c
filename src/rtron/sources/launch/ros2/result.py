"""What a launch of ROS 2 starts, found without running anything."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from rtron.sources.launch.common.yaml_tree import YamlTree
from rtron.sources.launch.ros2.parameters.merge import (
    ParameterSource,
    given_parameters,
    loaded_parameters,
)
from rtron.vocabulary import Evidence, Unresolved, Word
from rtron.vocabulary.parameters import Parameter
from rtron.vocabulary.remap_rules import UNKNOWN, Rule


class StartKind(Word):
    """What a launch starts: processes, and components that containers load."""

    NODE = "node"
    LIFECYCLE_NODE = "lifecycle_node"
    CONTAINER = "container"
    COMPONENT = "component"
    PROCESS = "process"


@dataclass(frozen=True, slots=True, kw_only=True)
class Start:
    """A node, component or process that a launch starts.

    `name` is empty where the program names its node itself; `full_name` then ends in `*`. What is
    not known of a text stands in braces. `placed` says that a namespace is given. `program` is an
    executable, or a component's class, which the node `container` loads. `remaps` are in order: the
    first that fits a name counts, `shared` of them are not the node's own. `arguments` are the
    words of a command line, for a process the whole of it. `complete` says that every parameter
    file is known, `extra` are a component's extra arguments. `conditions` are those that it stands
    under, `doubtful` says that one of them is not known. `event` is what it waits for. `chain` has
    the includes around, outermost first. `executed` says that the launch file was run to find it;
    conditions and chain are not known then.
    """

    kind: StartKind
    package: str = ""
    program: str = ""
    name: str = ""
    namespace: str = "/"
    placed: bool = False
    remaps: tuple[Rule, ...] = ()
    shared: int = 0
    sources: tuple[ParameterSource, ...] = ()
    complete: bool = True
    arguments: tuple[str, ...] = ()
    environ: tuple[tuple[str, str], ...] = ()
    container: str = ""
    extra: Mapping[str, Parameter] = field(default_factory=dict)
    conditions: tuple[Evidence, ...] = ()
    doubtful: bool = False
    event: str = ""
    evidence: Evidence
    chain: tuple[Evidence, ...] = ()
    executed: bool = False

    @property
    def full_name(self) -> str:
        """The node's full name."""
        return f"{self.namespace.rstrip('/')}/{self.name or UNKNOWN}"

    def parameters(self) -> dict[str, Parameter]:
        """Return the parameters that it is given, as `given_parameters` merges them.

        For a component launch_ros takes them together itself, as `loaded_parameters` says.
        """
        if self.kind is StartKind.COMPONENT:
            return loaded_parameters(self.sources, self.full_name)
        return given_parameters(self.sources, self.full_name)


@dataclass(frozen=True, slots=True, kw_only=True)
class Argument:
    """An argument that a launch file declares; `default` is None for one that must be given."""

    name: str
    default: str | None
    description: str
    evidence: Evidence


@dataclass(frozen=True, slots=True, kw_only=True)
class Included:
    """A file that a launch file includes, with the arguments it is given there."""

    file: str
    arguments: tuple[tuple[str, str], ...]
    evidence: Evidence
    includes: tuple["Included", ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class AppLaunch:
    """What a launch file starts, in the order of starting, with all that it includes.

    `arguments` are those that the file itself declares; `unresolved` is what could not be read.
    `made` are the files that exist only while the launch runs, by what they are called.
    """

    file: str
    made: Mapping[str, YamlTree] = field(default_factory=dict)
    starts: tuple[Start, ...] = ()
    arguments: tuple[Argument, ...] = ()
    includes: tuple[Included, ...] = ()
    unresolved: tuple[Unresolved, ...] = ()

"""What a node declares through its client library, found in source, a model or a plugin."""

from dataclasses import dataclass, field, replace
from math import isfinite

from rtron.vocabulary import (
    Evidence,
    LastMessageFate,
    NodeParameter,
    NodeParameterValue,
    ParameterTree,
    ParameterValue,
    QoS,
    Resolution,
    StringEnum,
    UnresolvedCause,
    UnresolvedItem,
)
from rtron.vocabulary.enums import HiddenPart

MAX_VALUE_LENGTH = 4096


def plain_value(value: object) -> NodeParameterValue | None:
    """Return a parameter's value as a graph tells it; None for what is long or none of ROS 2."""
    if isinstance(value, (list, tuple)):
        items = [plain_value(item) for item in value[:MAX_VALUE_LENGTH]]
        values = tuple(item for item in items if isinstance(item, (bool, int, float, str)))
        return values if len(values) == len(value) else None
    if isinstance(value, str):
        return str(value) if len(value) <= MAX_VALUE_LENGTH else None
    if isinstance(value, float):
        return value if isfinite(value) else None
    return value if isinstance(value, int) else None


class DeclarationKind(StringEnum):
    """The calls of a client library that join a node to others."""

    PUBLISH = "publish"
    SUBSCRIBE = "subscribe"
    SERVICE = "service"
    SERVICE_CLIENT = "service_client"
    ACTION_CLIENT = "action_client"
    ACTION_SERVER = "action_server"


@dataclass(frozen=True, slots=True, kw_only=True)
class Declaration:
    """One declared name.

    `name` is absolute, as it resolves in its node before any remapping; what is not known of it
    stands in braces (`/{~prefix}/scan`). An action's `name` is its namespace and its `type` ends
    in `Action`. `implicit` marks what a library declares by itself, `undecided` what stands under a
    condition that is not known.

    ROS 2: `type` is `package/msg/Name`, an action's `package/action/Name`; `node` is the full name
    of the node, of which a process may have several; `evidence` begins where the name is given,
    and ends where a wrapper hands it to the client library; `qos` is there where it is literal.
    """

    kind: DeclarationKind
    name: str
    type: str = ""
    node: str = ""
    qos: QoS | None = None
    implicit: bool = False
    undecided: bool = False
    latched: bool = False
    resolution: Resolution = Resolution.LITERAL
    evidence: tuple[Evidence, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterSetting:
    """A parameter that a launch sets in ROS 2, for the nodes whose full name fits `node`.

    `node` is a key of a parameter file (`/**`, `/robot/*`, `/robot/driver`), `name` has its dots.
    """

    node: str
    name: str
    value: ParameterValue


_FORWARDED = "forward_global_arguments"


@dataclass(frozen=True, slots=True, kw_only=True)
class ComponentLoading:
    """How a container loads a component (rclcpp_components: ComponentManager).

    `container` is the full name of the node that loads it, `is_process_known` says that a launch
    that is read tells all that this process is started with. `options` are the extra arguments.
    """

    container: str
    is_process_known: bool = True
    options: tuple[tuple[str, ParameterValue], ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class HardwareDescription:
    """What a robot description says of a hardware component: its name and its parameters."""

    name: str
    parameters: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadedPlugin:
    """A plugin that a node loads: its class as pluginlib names it, and what the node calls it.

    In ROS 1 the name is relative to the loading node, `global_costmap/obstacles`. In ROS 2 `node`
    is the one that the plugin gets, which may be another one of the process: a costmap.
    """

    class_name: str
    name: str
    node: str
    base: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeSite:
    """A node where it runs: its full name, its command line and the parameters of the launch.

    `remaps` lead from absolute declared names to absolute targets. `parameters_complete` says that
    `parameters` holds all there are: what is not in it is not set.

    In ROS 2 (`ros`) the parameters are `settings`, of which the last that fits counts.
    `has_launch_name` and `has_launch_namespace` say that the launch gives the name and the
    namespace; where it does not, the source does. They are for every node of the process that takes
    the process's arguments. Of a component that is loaded (`loading`) they are its container's;
    `args` and `overrides` are its own, the arguments and the parameters of the options that it is
    loaded with. `remap_rules` are remap rules as written, of which the first that fits counts.
    `hardware` is the component of ros2_control that runs in the process, `plugin` a class that its
    node loads. In ROS 1, `manager` is the node whose process a nodelet runs in.
    """

    name: str
    args: tuple[str, ...] = ()
    parameters: ParameterTree = field(default_factory=ParameterTree)
    remaps: tuple[tuple[str, str], ...] = ()
    environ: tuple[tuple[str, str], ...] = ()
    parameters_complete: bool = True
    ros: int = 1
    has_launch_name: bool = True
    has_launch_namespace: bool = True
    settings: tuple[ParameterSetting, ...] = ()
    overrides: tuple[tuple[str, ParameterValue], ...] = ()
    loading: ComponentLoading | None = None
    remap_rules: tuple[tuple[str, str], ...] = ()
    hardware: HardwareDescription | None = None
    plugin: LoadedPlugin | None = None
    manager: str = ""

    @property
    def process_name(self) -> str:
        """The full name that a launch gives the nodes of the process."""
        return self.loading.container if self.loading else self.manager or self.name

    @property
    def node_settings(self) -> tuple[ParameterSetting, ...]:
        """The settings that count for the node itself.

        A component has its container's only if `forward_global_arguments` says so
        (rclcpp_components: ComponentManager).
        """
        options = dict(self.loading.options) if self.loading else {_FORWARDED: True}
        return self.settings if options.get(_FORWARDED) is True else ()


@dataclass(frozen=True, slots=True, kw_only=True)
class RuntimeStart:
    """A launch file, or a node, that a node starts itself: a path, or `package/file`."""

    path: str
    args: tuple[str, ...] = ()
    evidence: tuple[Evidence, ...] = ()

    def unread(self, owner: str, why: str, cause: UnresolvedCause | None = None) -> UnresolvedItem:
        """Return the note that a launch file is not read which a node starts, its owner."""
        package, slash, _ = self.path.partition("/")
        what = f"launch {self.path} that {owner} starts"
        note = UnresolvedItem(what=what, why=why, package=package if slash else "", cause=cause)
        return replace(note, hides=HiddenPart.NODES, evidence=self.evidence)


@dataclass(frozen=True, slots=True, kw_only=True)
class CreatedNode:
    """A node that a process of ROS 2 makes: its full name, and the remaps that it gives itself.

    The remaps are rules as written, and count before the process's. `uses_global_arguments` says
    that the process's own count for it at all (rclcpp: NodeOptions::use_global_arguments).
    """

    name: str
    remaps: tuple[tuple[str, str], ...] = ()
    uses_global_arguments: bool = True
    evidence: tuple[Evidence, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameBroadcast:
    """A transform that a node broadcasts: its child frame and its parent frame, empty if not known.

    `is_fixed` says that it never changes. `is_certain` says that no parameter whose value is not
    known decides whether the node broadcasts it.
    """

    child: str
    parent: str = ""
    is_fixed: bool = False
    is_certain: bool = True
    evidence: tuple[Evidence, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class FrameUse:
    """A frame that a node writes into the header of a message, or looks up, and where."""

    frame: str
    evidence: Evidence
    is_look_up: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class PluginId:
    """The id of a plugin that a server has, or that a request asks for, and where.

    The name is the field of the request in the node's namespace, and the id below it:
    `/robot/planner_id/GridBased`.
    """

    name: str
    evidence: Evidence
    is_request: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class LastMessageUse:
    """What becomes of a subscription's last message, after so many seconds if they are known.

    `evidence` is where the subscription is made, then where its age is looked at, or where the
    publishers are made that repeat it.
    """

    fate: LastMessageFate
    seconds: float | None = None
    evidence: tuple[Evidence, ...]


class FlowInput(StringEnum):
    """What makes a program act."""

    MESSAGE = "message"
    REQUEST = "request"
    START = "start"


@dataclass(frozen=True, slots=True, kw_only=True)
class MessageFlow:
    """Where a program takes its input, and where the publishers are that it leads to.

    `requests` are services and actions; the first is that which a request asks for. `outputs` are
    libraries' objects or modules that it is given to. What leads to nothing is not used.
    """

    input: FlowInput
    evidence: tuple[Evidence, ...]
    requests: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class MistypedParameter:
    """A parameter of ROS 2 that is given another type than its node declares: that throws."""

    node: str
    name: str
    declared_type: str
    given_type: str
    evidence: Evidence


@dataclass(frozen=True, slots=True, kw_only=True)
class GazeboTopic:
    """A topic on Gazebo's own side, of a bridge or, where that is empty, of a robot.

    `type` is without its package; the messages go to ROS, to Gazebo or, of a bridge, both ways.
    `models` are the names that the robot's model may have, and a `*` in `name` is not known.
    """

    name: str
    type: str
    to_ros: bool
    to_gazebo: bool
    bridge: str = ""
    models: frozenset[str] = frozenset()
    evidence: tuple[Evidence, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeInterface:
    """All that one node declares, and what of it could not be found out.

    `nodes` are those of a process of ROS 2, in the order they are made, `parameters` theirs.
    `frames` are the transforms, `frame_uses` the frames of its messages and those that it looks up,
    as far as they are known,
    `plugins` those classes that a model says to be loaded, and that have no model themselves: each
    has a note called like its class.
    """

    nodes: tuple[CreatedNode, ...] = ()
    declarations: tuple[Declaration, ...] = ()
    runtime_starts: tuple[RuntimeStart, ...] = ()
    unresolved: tuple[UnresolvedItem, ...] = ()
    parameters: tuple[NodeParameter, ...] = ()
    frames: tuple[FrameBroadcast, ...] = ()
    frame_uses: tuple[FrameUse, ...] = ()
    plugin_ids: tuple[PluginId, ...] = ()
    plugins: tuple[LoadedPlugin, ...] = ()
    mistyped: tuple[MistypedParameter, ...] = ()
    last_messages: tuple[LastMessageUse, ...] = ()
    message_flows: tuple[MessageFlow, ...] = ()
    gazebo_topics: tuple[GazeboTopic, ...] = ()

    def with_location(self, location: Evidence) -> "NodeInterface":
        """Return the interface with a plugin's place in its file before its model's evidence."""
        declarations = (replace(d, evidence=(location, *d.evidence)) for d in self.declarations)
        return replace(self, declarations=tuple(declarations))

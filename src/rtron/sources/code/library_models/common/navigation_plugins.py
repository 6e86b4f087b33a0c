"""The plugins of the navigation stacks, started with what their base classes subscribe and publish.

Sources: navigation (costmap_2d, nav_core), move_base_flex (mbf_costmap_core) and navigation2
(nav2_costmap_2d, nav2_core). What these have of their own source counts before.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine, ThrownError
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.interpreter.execution.exceptions import is_caught
from rtron.sources.code.interpreter.execution.language_runtime import cpp_runtime
from rtron.sources.code.library_models.common.trivial_functions import returning_field
from rtron.sources.code.library_models.rclcpp.node import make_node
from rtron.sources.code.library_models.rclcpp.parameters import declare_parameter
from rtron.vocabulary import UnresolvedCause

_THROWN = ("CreateClassException", "PluginlibException", "runtime_error", "exception")


def throw_for_another_base(machine: AbstractMachine, name: av.Value) -> None:
    """Throw what pluginlib throws for a class of another base, if that is caught."""
    thrown, files = ThrownError(*_THROWN), machine.runtime.files
    is_here = isinstance(name, av.Scalar) and files.is_plugin(str(name.value))
    if is_here and is_caught(machine.active_handlers, thrown):
        raise thrown


def note_missing_plugin(machine: AbstractMachine, name: av.Value, at: Arguments) -> None:
    """Note a plugin that is not here, or that only the running app names, and who loads it."""
    node = machine.recorder.site.name
    why, cause = f"{node} loads it, and which one it is, is not known", None
    if isinstance(name, av.Scalar):
        why = f"{node} loads it, and its source is not found: give the folder of its source too"
        cause = UnresolvedCause.MISSING_CODE
    what = f"plugin {av.text_with_holes(name)}"
    machine.recorder.add_unresolved(what, why, at.evidence, cause=cause)


@dataclass(frozen=True, slots=True)
class PluginBase:
    """A base class: how a plugin is started, by what method with what, and what is called later."""

    method: str
    given: tuple[str, ...]
    later: tuple[str, ...] = ()


_LAYER_CALLS = ("activate", "updateBounds", "updateCosts", "matchSize", "deactivate", "reset")
_PLANNER_CALLS = ("makePlan", "createPlan", "cancel")
_CONTROLLER_CALLS = ("setPlan", "computeVelocityCommands", "isGoalReached", "cancel")
_RECOVERY_CALLS = ("runBehavior", "cancel")
_ROS1_PLANNER = PluginBase("initialize", ("name", "costmap"), _PLANNER_CALLS)
_ROS1_CONTROLLER = PluginBase("initialize", ("name", "tf", "costmap"), _CONTROLLER_CALLS)
_ROS1_RECOVERY = PluginBase("initialize", ("name", "tf", "global", "local"), _RECOVERY_CALLS)
_PARTS = ("node", "name", "tf", "costmap", "footprint")
PLUGIN_BASES: Mapping[str, PluginBase] = {
    "costmap_2d::Layer": PluginBase("initialize", ("costmap", "name", "tf"), _LAYER_CALLS),
    "nav_core::BaseGlobalPlanner": _ROS1_PLANNER,
    "nav_core::BaseLocalPlanner": _ROS1_CONTROLLER,
    "nav_core::RecoveryBehavior": _ROS1_RECOVERY,
    "mbf_costmap_core::CostmapPlanner": _ROS1_PLANNER,
    "mbf_costmap_core::CostmapController": _ROS1_CONTROLLER,
    "mbf_costmap_core::CostmapRecovery": _ROS1_RECOVERY,
    "nav2_costmap_2d::Layer": PluginBase(
        "initialize", ("costmap", "name", "tf", "node", "callback_group"), _LAYER_CALLS
    ),
    "nav2_core::GlobalPlanner": PluginBase("configure", _PARTS[:4], ("activate", "createPlan")),
    "nav2_core::Controller": PluginBase(
        "configure", _PARTS[:4], ("activate", "setPlan", "computeVelocityCommands")
    ),
    "nav2_core::Smoother": PluginBase("configure", _PARTS, ("activate", "smooth")),
    "nav2_core::Behavior": PluginBase("configure", _PARTS, ("activate",)),
    "nav2_core::GoalChecker": PluginBase(
        "initialize", ("node", "name", "costmap"), ("reset", "isGoalReached")
    ),
    "nav2_core::ProgressChecker": PluginBase("initialize", ("node", "name"), ("reset", "check")),
    "nav2_core::WaypointTaskExecutor": PluginBase(
        "initialize", ("node", "name"), ("processAtWaypoint",)
    ),
}
"""The bases whose plugins are followed where a node of a model loads them."""


def start_plugin(machine: AbstractMachine, plugin: av.Value, at: Arguments) -> None:
    """Start what the node of a site loads, with its name and, in ROS 2, its node."""
    loaded = machine.recorder.site.plugin
    if loaded is None:
        return
    base = PLUGIN_BASES[loaded.base]
    known: dict[str, av.Value] = {"name": av.Scalar(loaded.name, tainted=True)}
    if "node" in base.given:
        known["node"] = _plugin_node(machine, at)
    method = cpp_runtime(machine).attribute(plugin, base.method, ())
    given = [known.get(word, av.Unknown(word)) for word in base.given]
    dispatch(machine, method or av.Unknown(base.method), at.with_values(*given))


def _plugin_node(machine: AbstractMachine, at: Arguments) -> av.Instance:
    space, _, name = machine.recorder.site.name.rpartition("/")
    words = (av.Scalar(name), av.Scalar(space or "/"))
    return make_node(machine, at.with_values(*words), lifecycle=True)


def _initialize(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`Layer::initialize(costmap, name, tf[, node, …])` keeps these, and calls `onInitialize`."""
    fields = ("layered_costmap_", "name_", "tf_", "node_")
    for field, value in zip(fields, arguments.values, strict=False):
        machine.undo_log.set(owner.fields, field, value)
    method = machine.runtime.attribute(owner, "onInitialize", ())
    return dispatch(machine, method or av.Unknown("onInitialize"), arguments.with_values())


def _full_name(_: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`getFullName(parameter)` is below the layer's name."""
    return av.concat((owner.fields.get("name_", av.UNKNOWN), av.Scalar("."), arguments.value(0)))


def _declare(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`declareParameter(name, default)` of a layer in ROS 2."""
    values = (_full_name(machine, owner, arguments), *arguments.values[1:])
    node = owner.fields.get("node_", av.UNKNOWN)
    return declare_parameter(machine, node, arguments.with_values(*values))


_LAYER_METHODS: dict[str, Callable[..., av.Value]] = {
    "initialize": _initialize,
    "getName": returning_field("name_"),
    "getFullName": _full_name,
    "declareParameter": _declare,
}
_LAYERS = ("costmap_2d::Layer", "costmap_2d::CostmapLayer")
NAVIGATION_CLASSES: Mapping[str, av.LibraryClass] = {
    **{
        name: av.LibraryClass(name, virtual_callbacks=base.later, over_source=False)
        for name, base in PLUGIN_BASES.items()
    },
    **{
        f"{prefix}{name}": av.LibraryClass(
            f"{prefix}{name}",
            methods=_LAYER_METHODS,
            virtual_callbacks=_LAYER_CALLS,
            over_source=False,
        )
        for prefix in ("", "nav2_")
        for name in _LAYERS
    },
}

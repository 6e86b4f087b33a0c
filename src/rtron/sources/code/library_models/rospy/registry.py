"""rospy and the Python libraries of ROS around it, as far as they join nodes."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine, ThrownError
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.exceptions import is_caught
from rtron.sources.code.library_models.common.transforms import BROADCASTERS
from rtron.sources.code.library_models.common.trivial_functions import (
    making,
    return_none,
    returning_unknown,
)
from rtron.sources.code.library_models.ros1_common import endpoints, names
from rtron.sources.declaration import DeclarationKind


def message_type_name(value: av.Value | None) -> str:
    """Return a message class as `package/Name`; empty where it is not known."""
    for option in av.options(value):
        if isinstance(option, av.MessageType):
            return option.name
    return ""


def _declare_endpoint(
    kind: DeclarationKind, machine: AbstractMachine, _: object, arguments: Arguments
) -> av.Instance:
    """`Publisher(name, data_class, …)`, `Subscriber(name, data_class, callback, …)` and so on."""
    name = names.resolve_name(machine, arguments.value(0, "name"))
    type = message_type_name(arguments.get(1, "data_class") or arguments.get(1, "service_class"))
    latched = av.truth(arguments.keywords.get("latch", av.FALSE)) is True
    endpoints.declare_endpoint(machine, kind, name, type, arguments, latched=latched)
    if arguments.get(3, "callback_args") is None:
        machine.escape_arguments(arguments)
    final = names.remap_name(machine, name)
    return av.Instance(_ENDPOINT, {"name": final, "resolved_name": final})


def _declare_subscriber(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Instance:
    """`Subscriber(name, data_class, callback, callback_args)`: its callback gets both."""
    made = _declare_endpoint(DeclarationKind.SUBSCRIBE, machine, None, arguments)
    given = arguments.get(3, "callback_args")
    if given is not None:
        for callback in av.options(arguments.get(2, "callback")):
            machine.escape(_with_callback_args(callback, given), arguments.evidence)
    return made


def _with_callback_args(callback: av.Value, given: av.Value) -> av.Value:
    if not isinstance(callback, av.FunctionValue):
        return callback
    before = len(callback.bound_arguments) + (callback.owner is not None)
    second = callback.function.params[before + 1 : before + 2]
    return replace(
        callback, bound_keywords={**callback.bound_keywords, **{p.name: given for p in second}}
    )


def _wait_for_message(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    _declare_endpoint(DeclarationKind.SUBSCRIBE, machine, None, arguments)
    return av.Unknown("message")


def _get_param(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    name = names.resolve_name(machine, arguments.value(0, "param_name"))
    default, found = arguments.get(1, "default"), names.parameter_value(machine, name)
    if default is not None and (found is None or isinstance(found, av.Unknown)):
        return names.tainted_default(default)
    if found is None:
        if is_caught(machine.active_handlers, missing := ThrownError("KeyError")):
            raise missing
        return av.Unknown(av.text_with_holes(arguments.value(0, "param_name")), tainted=True)
    return found


def _has_param(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    name = names.resolve_name(machine, arguments.value(0, "param_name"))
    return names.is_set(names.parameter_value(machine, name))


def _set_param(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    name = names.resolve_name(machine, arguments.value(0, "param_name"))
    if isinstance(name, av.Scalar):
        machine.undo_log.set(machine.parameters, str(name.value), arguments.get(1, "param_value"))
    return av.NONE


def _search_param(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    namespace = av.Scalar(machine.recorder.site.name)
    return names.search_parameter(machine, arguments.value(0, "param_name"), namespace) or av.NONE


def _resolve_name(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    return names.remap_name(machine, names.resolve_name(machine, arguments.value(0, "name")))


def _get_namespace(machine: AbstractMachine, _: object, __: Arguments) -> av.Value:
    namespace = names.node_namespace(machine)
    return av.Scalar(namespace if namespace == "/" else namespace + "/")


def _register_callback(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    machine.escape_arguments(arguments)
    return av.Unknown("timer")


def _declare_action(
    kind: DeclarationKind, machine: AbstractMachine, _: object, arguments: Arguments
) -> av.Value:
    name = names.resolve_name(
        machine, arguments.get(0, "ns") or arguments.get(0, "name") or av.UNKNOWN
    )
    type = arguments.get(1, "ActionSpec") or arguments.get(1, "action_spec")
    endpoints.declare_endpoint(machine, kind, name, message_type_name(type), arguments)
    machine.escape_arguments(arguments)
    return av.Instance(_ENDPOINT)


def _reconfigure_server(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    namespace = arguments.keywords.get("namespace") or arguments.get(2) or av.Scalar("")
    private = endpoints.resolve_private(machine)
    base = names.resolve_name(machine, namespace, private)
    endpoints.declare_library(machine, "dynamic_reconfigure", arguments, base)
    machine.escape_arguments(arguments)
    return av.Instance(_ENDPOINT)


def _reconfigure_client(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    namespace = names.resolve_name(machine, arguments.value(0, "name"))
    endpoints.declare_library(machine, "dynamic_reconfigure client", arguments, namespace)
    return av.Instance(_ENDPOINT)


def _declare(library: str, machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    endpoints.declare_library(machine, library, arguments)
    return av.Instance(BROADCASTERS.get(library, _ENDPOINT))


def _declare_bond(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    topic = names.resolve_name(machine, arguments.value(0, "topic"))
    endpoints.declare_library(machine, "bond", arguments, topic)
    return av.Instance(_ENDPOINT)


def _add_callbacks(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`registerCallback`, `register_goal_callback` and the like take callbacks."""
    machine.escape_arguments(arguments)
    return owner


def _message_class(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`get_message_class("std_msgs/String")` (roslib.message)."""

    def named(value: av.Value) -> av.Value:
        is_type = isinstance(value, av.Scalar) and str(value.value).count("/") == 1
        return av.MessageType(av.text_with_holes(value)) if is_type else av.Unknown("message class")

    return av.map_options(arguments.value(0), named)


def _make_move_group_client(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`MoveGroupCommander(name, robot_description, ns)`."""
    namespace = names.resolve_name(machine, arguments.get(2, "ns") or av.Scalar(""))
    endpoints.declare_library(machine, "move_group", arguments, namespace)
    return av.Instance(_ENDPOINT)


_ROBOT = av.LibraryClass(
    "moveit_commander.RobotCommander", methods={"get_group": _make_move_group_client}
)


def _make_planning_scene(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`PlanningSceneInterface(ns)` publishes what stands around the robot, or is in its hand."""
    namespace = names.resolve_name(machine, arguments.get(0, "ns") or av.Scalar(""))
    endpoints.declare_library(machine, "planning_scene", arguments, namespace)
    return av.Instance(_ENDPOINT)


def _note(machine: AbstractMachine, _: object, arguments: Arguments, *, name: str) -> av.Value:
    """Note what a library makes that has no model."""
    machine.escape_arguments(arguments)
    machine.recorder.add_unresolved(f"{name}()", "what it joins is not known", arguments.evidence)
    return av.Unknown(name)


_ENDPOINT = av.LibraryClass(
    "endpoint",
    methods=dict.fromkeys(
        [
            *("registerCallback", "register_goal_callback", "register_preempt_callback"),
            *("send_goal", "add", "on_shutdown", "send_goal_and_wait", "setCallback"),
        ],
        _add_callbacks,
    ),
)


RospyFunction = Callable[..., av.Value]

_CALLS: dict[str, RospyFunction] = {
    "rospy.Publisher": partial(_declare_endpoint, DeclarationKind.PUBLISH),
    "rospy.Subscriber": _declare_subscriber,
    **{
        f"rospy.{module}{name}": partial(_declare_endpoint, kind)
        for module in ("", "impl.tcpros_service.")
        for name, kind in (
            ("Service", DeclarationKind.SERVICE),
            ("ServiceProxy", DeclarationKind.SERVICE_CLIENT),
        )
    },
    "rospy.wait_for_message": _wait_for_message,
    "rospy.wait_for_service": return_none,
    "rospy.get_param": _get_param,
    "rospy.has_param": _has_param,
    "rospy.set_param": _set_param,
    "rospy.search_param": _search_param,
    "rospy.get_param_cached": _get_param,
    **{f"rospy.{name}": _resolve_name for name in ("resolve_name", "remap_name")},
    "rospy.names.resolve_name": _resolve_name,
    "rospy.names.ns_join": lambda machine, _, a: names.resolve_name(machine, a.get(1), a.get(0)),
    "rospy.get_name": lambda machine, __, ___: av.Scalar(machine.recorder.site.name),
    "rospy.get_namespace": _get_namespace,
    **{f"roslib.message.get_{kind}_class": _message_class for kind in ("message", "service")},
    "rospy.is_shutdown": returning_unknown("is_shutdown"),
    **dict.fromkeys(("rospy.Timer", "rospy.on_shutdown"), _register_callback),
    "message_filters.Subscriber": partial(_declare_endpoint, DeclarationKind.SUBSCRIBE),
    **{
        f"actionlib.{prefix}Action{side}": partial(_declare_action, kind)
        for prefix in ("Simple", "")
        for side, kind in (
            ("Client", DeclarationKind.ACTION_CLIENT),
            ("Server", DeclarationKind.ACTION_SERVER),
        )
    },
    **dict.fromkeys(
        (f"dynamic_reconfigure.server.{name}" for name in ("Server", "DynamicReconfigureServer")),
        _reconfigure_server,
    ),
    "dynamic_reconfigure.client.Client": _reconfigure_client,
    "smach_ros.SimpleActionState": partial(_declare_action, DeclarationKind.ACTION_CLIENT),
    "smach_ros.ServiceState": partial(_declare_endpoint, DeclarationKind.SERVICE_CLIENT),
    "smach_ros.MonitorState": partial(_declare_endpoint, DeclarationKind.SUBSCRIBE),
    **{
        f"smach_ros.{name}": partial(_note, name=f"smach_ros.{name}")
        for name in ("IntrospectionServer", "ActionServerWrapper")
    },
    "tf.TransformListener": partial(_declare, "TransformListener"),
    "tf.TransformBroadcaster": partial(_declare, "TransformBroadcaster"),
    **{f"tf2_ros.{name}": partial(_declare, name) for name in ("TransformListener", *BROADCASTERS)},
    **dict.fromkeys(
        ("diagnostic_updater.Updater", "diagnostic_updater.DiagnosticUpdater"),
        partial(_declare, "diagnostic_updater"),
    ),
    "bondpy.Bond": _declare_bond,
    "moveit_commander.MoveGroupCommander": _make_move_group_client,
    "moveit_commander.RobotCommander": making(_ROBOT),
    "moveit_commander.PlanningSceneInterface": _make_planning_scene,
}
ROSPY: dict[str, av.Value] = {
    **{name: av.LibraryFunction(name, call) for name, call in _CALLS.items()},
    **dict.fromkeys(("rospy.AnyMsg", "rospy.msg.AnyMsg"), av.MessageType("*")),
}

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
    return_none,
    returning_unknown,
)
from rtron.sources.code.library_models.ros1_common import endpoints
from rtron.sources.code.library_models.ros1_common.names import (
    node_namespace,
    parameter_value,
    remap_name,
    resolve_name,
    search_parameter,
)
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
    name = resolve_name(machine, arguments.value(0, "name"))
    type = message_type_name(arguments.get(1, "data_class") or arguments.get(1, "service_class"))
    latched = av.truth(arguments.keywords.get("latch", av.FALSE)) is True
    endpoints.declare_endpoint(machine, kind, name, type, arguments, latched=latched)
    if arguments.get(3, "callback_args") is None:
        machine.escape_arguments(arguments)
    final = remap_name(machine, name)
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
    name = resolve_name(machine, arguments.value(0, "param_name"))
    default, found = arguments.get(1, "default"), parameter_value(machine, name)
    if found is None and default is None:
        if is_caught(machine.active_handlers, missing := ThrownError("KeyError")):
            raise missing
        return av.Unknown(
            av.text_with_holes(arguments.get(0, "param_name") or av.NONE), tainted=True
        )
    if found is None:
        return _tainted_value(default)
    return (
        found if not isinstance(found, av.Unknown) or default is None else _tainted_value(default)
    )


def _tainted_value(value: av.Value | None) -> av.Value:
    return (
        av.Scalar(value.value, tainted=True) if isinstance(value, av.Scalar) else value or av.NONE
    )


def _has_param(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    found = parameter_value(machine, resolve_name(machine, arguments.value(0, "param_name")))
    return (
        av.FALSE
        if found is None
        else av.Unknown("has_param")
        if isinstance(found, av.Unknown)
        else av.TRUE
    )


def _set_param(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    name = resolve_name(machine, arguments.value(0, "param_name"))
    if isinstance(name, av.Scalar):
        machine.undo_log.set(machine.parameters, str(name.value), arguments.get(1, "param_value"))
    return av.NONE


def _search_param(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    namespace = av.Scalar(machine.recorder.site.name)
    return search_parameter(machine, arguments.value(0, "param_name"), namespace) or av.NONE


def _resolve_name(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    return remap_name(machine, resolve_name(machine, arguments.value(0, "name")))


def _get_name(machine: AbstractMachine, _: object, __: Arguments) -> av.Value:
    return av.Scalar(machine.recorder.site.name)


def _get_namespace(machine: AbstractMachine, _: object, __: Arguments) -> av.Value:
    namespace = node_namespace(machine)
    return av.Scalar(namespace if namespace == "/" else namespace + "/")


def _register_callback(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    machine.escape_arguments(arguments)
    return av.Unknown("timer")


def _declare_action(
    kind: DeclarationKind, machine: AbstractMachine, _: object, arguments: Arguments
) -> av.Value:
    name = resolve_name(machine, arguments.get(0, "ns") or arguments.get(0, "name") or av.UNKNOWN)
    type = arguments.get(1, "ActionSpec") or arguments.get(1, "action_spec")
    endpoints.declare_endpoint(machine, kind, name, message_type_name(type), arguments)
    machine.escape_arguments(arguments)
    return av.Instance(_ENDPOINT)


def _declare_reconfigure_server(
    machine: AbstractMachine, _: object, arguments: Arguments
) -> av.Value:
    namespace = arguments.keywords.get("namespace") or arguments.get(2) or av.Scalar("")
    private = endpoints.resolve_private(machine)
    base = resolve_name(machine, namespace, private)
    endpoints.declare_library(machine, "dynamic_reconfigure", arguments, base)
    machine.escape_arguments(arguments)
    return av.Instance(_ENDPOINT)


def _declare_reconfigure_client(
    machine: AbstractMachine, _: object, arguments: Arguments
) -> av.Value:
    namespace = resolve_name(machine, arguments.value(0, "name"))
    endpoints.declare_library(machine, "dynamic_reconfigure client", arguments, namespace)
    return av.Instance(_ENDPOINT)


def _declare_library(
    library: str, machine: AbstractMachine, _: object, arguments: Arguments
) -> av.Value:
    endpoints.declare_library(machine, library, arguments)
    return av.Instance(BROADCASTERS.get(library, _ENDPOINT))


def _declare_bond(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    topic = resolve_name(machine, arguments.value(0, "topic"))
    endpoints.declare_library(machine, "bond", arguments, topic)
    return av.Instance(_ENDPOINT)


def _register_callbacks(
    machine: AbstractMachine, owner: av.Instance, arguments: Arguments
) -> av.Value:
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
    namespace = resolve_name(machine, arguments.get(2, "ns") or av.Scalar(""))
    endpoints.declare_library(machine, "move_group", arguments, namespace)
    return av.Instance(_MOVE_GROUP, {"namespace": namespace})


def _make_robot_commander(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`RobotCommander(robot_description, ns)`: it makes clients of groups."""
    namespace = resolve_name(machine, arguments.get(1, "ns") or av.Scalar(""))
    return av.Instance(_ROBOT, {"namespace": namespace})


def _get_group(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    endpoints.declare_library(machine, "move_group", arguments, owner.fields["namespace"])
    return av.Instance(_MOVE_GROUP, owner.fields)


def _call_manipulation(
    machine: AbstractMachine, owner: av.Instance, arguments: Arguments, *, name: str, type: str
) -> av.Value:
    """`pick(…)` and `place(…)` send goals of actions of their own."""
    full, kind = resolve_name(machine, av.Scalar(name), owner.fields["namespace"]), _ACTION_CLIENT
    endpoints.declare_endpoint(machine, kind, full, f"moveit_msgs/{type}", arguments)
    return av.Unknown(name)


def _make_planning_scene(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`PlanningSceneInterface(ns)` publishes what stands around the robot, or is in its hand."""
    namespace = resolve_name(machine, arguments.get(0, "ns") or av.Scalar(""))
    endpoints.declare_library(machine, "planning_scene", arguments, namespace)
    return av.Instance(_ENDPOINT)


_ACTION_CLIENT = DeclarationKind.ACTION_CLIENT
_MOVE_GROUP = av.LibraryClass(
    "moveit_commander.MoveGroupCommander",
    methods={
        "pick": partial(_call_manipulation, name="pickup", type="PickupAction"),
        "place": partial(_call_manipulation, name="place", type="PlaceAction"),
    },
)
_ROBOT = av.LibraryClass("moveit_commander.RobotCommander", methods={"get_group": _get_group})


def _note_library(
    machine: AbstractMachine, _: object, arguments: Arguments, *, name: str
) -> av.Value:
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
        _register_callbacks,
    ),
)


RospyFunction = Callable[..., av.Value]

_CALLS: dict[str, RospyFunction] = {
    "rospy.Publisher": partial(_declare_endpoint, DeclarationKind.PUBLISH),
    "rospy.Subscriber": _declare_subscriber,
    "rospy.Service": partial(_declare_endpoint, DeclarationKind.SERVICE),
    "rospy.ServiceProxy": partial(_declare_endpoint, DeclarationKind.SERVICE_CLIENT),
    "rospy.wait_for_message": _wait_for_message,
    "rospy.wait_for_service": return_none,
    "rospy.get_param": _get_param,
    "rospy.has_param": _has_param,
    "rospy.set_param": _set_param,
    "rospy.search_param": _search_param,
    "rospy.get_param_cached": _get_param,
    "rospy.resolve_name": _resolve_name,
    "rospy.remap_name": _resolve_name,
    "rospy.names.resolve_name": _resolve_name,
    "rospy.names.ns_join": lambda machine, _, a: resolve_name(machine, a.get(1), a.get(0)),
    "rospy.get_name": _get_name,
    "rospy.get_namespace": _get_namespace,
    "roslib.message.get_message_class": _message_class,
    "rospy.is_shutdown": returning_unknown("is_shutdown"),
    "rospy.Timer": _register_callback,
    "rospy.on_shutdown": _register_callback,
    "message_filters.Subscriber": partial(_declare_endpoint, DeclarationKind.SUBSCRIBE),
    "actionlib.SimpleActionClient": partial(_declare_action, DeclarationKind.ACTION_CLIENT),
    "actionlib.ActionClient": partial(_declare_action, DeclarationKind.ACTION_CLIENT),
    "actionlib.SimpleActionServer": partial(_declare_action, DeclarationKind.ACTION_SERVER),
    "actionlib.ActionServer": partial(_declare_action, DeclarationKind.ACTION_SERVER),
    "dynamic_reconfigure.server.Server": _declare_reconfigure_server,
    "dynamic_reconfigure.client.Client": _declare_reconfigure_client,
    "smach_ros.SimpleActionState": partial(_declare_action, DeclarationKind.ACTION_CLIENT),
    "smach_ros.ServiceState": partial(_declare_endpoint, DeclarationKind.SERVICE_CLIENT),
    "smach_ros.MonitorState": partial(_declare_endpoint, DeclarationKind.SUBSCRIBE),
    **{
        f"smach_ros.{name}": partial(_note_library, name=f"smach_ros.{name}")
        for name in ("IntrospectionServer", "ActionServerWrapper")
    },
    "tf.TransformListener": partial(_declare_library, "TransformListener"),
    "tf.TransformBroadcaster": partial(_declare_library, "TransformBroadcaster"),
    **{
        f"tf2_ros.{name}": partial(_declare_library, name)
        for name in ("TransformListener", *BROADCASTERS)
    },
    **dict.fromkeys(
        ("diagnostic_updater.Updater", "diagnostic_updater.DiagnosticUpdater"),
        partial(_declare_library, "diagnostic_updater"),
    ),
    "bondpy.bondpy.Bond": _declare_bond,
    "bondpy.Bond": _declare_bond,
    "moveit_commander.MoveGroupCommander": _make_move_group_client,
    "moveit_commander.RobotCommander": _make_robot_commander,
    "moveit_commander.PlanningSceneInterface": _make_planning_scene,
}
_ALIASES = {
    "moveit_commander.move_group.MoveGroupCommander": "moveit_commander.MoveGroupCommander",
    "moveit_commander.robot.RobotCommander": "moveit_commander.RobotCommander",
    "actionlib.simple_action_client.SimpleActionClient": "actionlib.SimpleActionClient",
    "actionlib.simple_action_server.SimpleActionServer": "actionlib.SimpleActionServer",
    "actionlib.action_client.ActionClient": "actionlib.ActionClient",
    "actionlib.action_server.ActionServer": "actionlib.ActionServer",
    "dynamic_reconfigure.server.DynamicReconfigureServer": "dynamic_reconfigure.server.Server",
    "tf.listener.TransformListener": "tf.TransformListener",
    "tf.broadcaster.TransformBroadcaster": "tf.TransformBroadcaster",
    "tf2_ros.transform_listener.TransformListener": "tf2_ros.TransformListener",
    "tf2_ros.transform_broadcaster.TransformBroadcaster": "tf2_ros.TransformBroadcaster",
    "rospy.topics.Publisher": "rospy.Publisher",
    "rospy.topics.Subscriber": "rospy.Subscriber",
    "rospy.impl.tcpros_service.Service": "rospy.Service",
    "rospy.impl.tcpros_service.ServiceProxy": "rospy.ServiceProxy",
    "smach_ros.simple_action_state.SimpleActionState": "smach_ros.SimpleActionState",
    "smach_ros.service_state.ServiceState": "smach_ros.ServiceState",
    "smach_ros.monitor_state.MonitorState": "smach_ros.MonitorState",
    "rospy.timer.Timer": "rospy.Timer",
    "rospy.rostime.Timer": "rospy.Timer",
    "roslib.message.get_service_class": "roslib.message.get_message_class",
}

ROSPY: dict[str, av.Value] = {
    **{name: av.LibraryFunction(name, call) for name, call in _CALLS.items()},
    **{alias: av.LibraryFunction(of, _CALLS[of]) for alias, of in _ALIASES.items()},
    "rospy.AnyMsg": av.MessageType("*"),
    "rospy.msg.AnyMsg": av.MessageType("*"),
}

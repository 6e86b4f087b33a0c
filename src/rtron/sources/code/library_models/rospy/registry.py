"""rospy and the Python libraries of ROS around it, as far as they join nodes."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    NONE,
    TRUE,
    FunctionValue,
    Hole,
    Instance,
    Known,
    MessageType,
    Native,
    NativeClass,
    Value,
    each,
    options,
    spelled,
    truth,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine, ThrownError
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros1_common import endpoints
from rtron.sources.code.library_models.ros1_common.names import (
    node_namespace,
    parameter,
    remapped,
    resolve,
    search,
)
from rtron.sources.declaration import DeclarationKind


def type_name(value: Value | None) -> str:
    """Return a message class as `package/Name`; empty where it is not known."""
    for option in options(value):
        if isinstance(option, MessageType):
            return option.name
    return ""


def _endpoint(kind: DeclarationKind, machine: Machine, _: object, arguments: Arguments) -> Instance:
    """`Publisher(name, data_class, …)`, `Subscriber(name, data_class, callback, …)` and so on."""
    name = resolve(machine, arguments.get(0, "name") or Hole("?"))
    type = type_name(arguments.get(1, "data_class") or arguments.get(1, "service_class"))
    latched = truth(arguments.keywords.get("latch", FALSE)) is True
    endpoints.declare(machine, kind, name, type, arguments, latched=latched)
    if arguments.get(3, "callback_args") is None:
        _escape_all(machine, arguments)
    final = remapped(machine, name)
    return Instance(_ENDPOINT, {"name": final, "resolved_name": final})


def _subscriber(machine: Machine, _: object, arguments: Arguments) -> Instance:
    """`Subscriber(name, data_class, callback, callback_args)`: its callback gets both."""
    made = _endpoint(DeclarationKind.SUBSCRIBE, machine, None, arguments)
    given = arguments.get(3, "callback_args")
    if given is not None:
        for callback in options(arguments.get(2, "callback")):
            machine.escape(_with_second(callback, given))
    return made


def _with_second(callback: Value, given: Value) -> Value:
    if not isinstance(callback, FunctionValue):
        return callback
    before = len(callback.given) + (callback.owner is not None)
    second = callback.function.params[before + 1 : before + 2]
    return replace(callback, named={**callback.named, **{p.name: given for p in second}})


def _escape_all(machine: Machine, arguments: Arguments) -> None:
    for value in (*arguments.values, *arguments.keywords.values()):
        machine.escape(value)


def _wait_for_message(machine: Machine, _: object, arguments: Arguments) -> Value:
    _endpoint(DeclarationKind.SUBSCRIBE, machine, None, arguments)
    return Hole("message")


def _get_param(machine: Machine, _: object, arguments: Arguments) -> Value:
    name = resolve(machine, arguments.get(0, "param_name") or Hole("?"))
    default, found = arguments.get(1, "default"), parameter(machine, name)
    if found is None and default is None:
        if machine.catching:
            raise ThrownError("KeyError")
        return Hole(spelled(arguments.get(0, "param_name") or NONE), tainted=True)
    if found is None:
        return _tainted(default)
    return found if not isinstance(found, Hole) or default is None else _tainted(default)


def _tainted(value: Value | None) -> Value:
    return Known(value.value, tainted=True) if isinstance(value, Known) else value or NONE


def _has_param(machine: Machine, _: object, arguments: Arguments) -> Value:
    found = parameter(machine, resolve(machine, arguments.get(0, "param_name") or Hole("?")))
    return FALSE if found is None else Hole("has_param") if isinstance(found, Hole) else TRUE


def _set_param(machine: Machine, _: object, arguments: Arguments) -> Value:
    name = resolve(machine, arguments.get(0, "param_name") or Hole("?"))
    if isinstance(name, Known):
        machine.trail.set(machine.parameters, str(name.value), arguments.get(1, "param_value"))
    return NONE


def _search_param(machine: Machine, _: object, arguments: Arguments) -> Value:
    namespace = Known(machine.recorder.site.name)
    return search(machine, arguments.get(0, "param_name") or Hole("?"), namespace) or NONE


def _resolve_name(machine: Machine, _: object, arguments: Arguments) -> Value:
    return remapped(machine, resolve(machine, arguments.get(0, "name") or Hole("?")))


def _get_name(machine: Machine, _: object, __: Arguments) -> Value:
    return Known(machine.recorder.site.name)


def _get_namespace(machine: Machine, _: object, __: Arguments) -> Value:
    namespace = node_namespace(machine)
    return Known(namespace if namespace == "/" else namespace + "/")


def _timer(machine: Machine, _: object, arguments: Arguments) -> Value:
    _escape_all(machine, arguments)
    return Hole("timer")


def _action(kind: DeclarationKind, machine: Machine, _: object, arguments: Arguments) -> Value:
    name = resolve(machine, arguments.get(0, "ns") or arguments.get(0, "name") or Hole("?"))
    type = arguments.get(1, "ActionSpec") or arguments.get(1, "action_spec")
    endpoints.declare(machine, kind, name, type_name(type), arguments)
    _escape_all(machine, arguments)
    return Instance(_ENDPOINT)


def _reconfigure(machine: Machine, _: object, arguments: Arguments) -> Value:
    namespace = arguments.keywords.get("namespace") or arguments.get(2) or Known("")
    private = endpoints.own_namespace(machine)
    endpoints.dynamic_reconfigure(machine, resolve(machine, namespace, private), arguments)
    _escape_all(machine, arguments)
    return Instance(_ENDPOINT)


def _reconfigure_client(machine: Machine, _: object, arguments: Arguments) -> Value:
    namespace = resolve(machine, arguments.get(0, "name") or Hole("?"))
    for name, type in (
        ("parameter_descriptions", "dynamic_reconfigure/ConfigDescription"),
        ("parameter_updates", "dynamic_reconfigure/Config"),
    ):
        topic = endpoints.below(namespace, name)
        kind = DeclarationKind.SUBSCRIBE
        endpoints.declare(machine, kind, topic, type, arguments, implicit=True)
    service, type = endpoints.below(namespace, "set_parameters"), "dynamic_reconfigure/Reconfigure"
    kind = DeclarationKind.SERVICE_CLIENT
    endpoints.declare(machine, kind, service, type, arguments, implicit=True)
    return Instance(_ENDPOINT)


def _transforms(
    kind: DeclarationKind,
    machine: Machine,
    _: object,
    arguments: Arguments,
    *,
    static: bool = False,
) -> Value:
    endpoints.transforms(machine, kind, arguments, static=static)
    return Instance(_ENDPOINT)


def _diagnostics(machine: Machine, _: object, arguments: Arguments) -> Value:
    endpoints.diagnostics(machine, arguments)
    return Instance(_ENDPOINT)


def _bond(machine: Machine, _: object, arguments: Arguments) -> Value:
    endpoints.bond(machine, resolve(machine, arguments.get(0, "topic") or Hole("?")), arguments)
    return Instance(_ENDPOINT)


def _wait_for_service(_: Machine, __: object, ___: Arguments) -> Value:
    return NONE


def _method(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`registerCallback`, `register_goal_callback` and their kin take callbacks."""
    _escape_all(machine, arguments)
    return owner


def _message_class(_: Machine, __: object, arguments: Arguments) -> Value:
    """`get_message_class("std_msgs/String")` (roslib.message)."""

    def named(value: Value) -> Value:
        is_type = isinstance(value, Known) and str(value.value).count("/") == 1
        return MessageType(spelled(value)) if is_type else Hole("message class")

    return each(arguments.get(0) or Hole("?"), named)


def _not_shut_down(_: Machine, __: object, ___: Arguments) -> Value:
    return Hole("is_shutdown")


_ENDPOINT = NativeClass(
    "endpoint",
    methods=dict.fromkeys(
        [
            "registerCallback",
            "register_goal_callback",
            "register_preempt_callback",
            "send_goal",
            "add",
            "on_shutdown",
            "send_goal_and_wait",
            "setCallback",
        ],
        _method,
    ),
)


PythonFunction = Callable[..., Value]

_CALLS: dict[str, PythonFunction] = {
    "rospy.Publisher": partial(_endpoint, DeclarationKind.PUBLISH),
    "rospy.Subscriber": _subscriber,
    "rospy.Service": partial(_endpoint, DeclarationKind.SERVICE),
    "rospy.ServiceProxy": partial(_endpoint, DeclarationKind.SERVICE_CLIENT),
    "rospy.wait_for_message": _wait_for_message,
    "rospy.wait_for_service": _wait_for_service,
    "rospy.get_param": _get_param,
    "rospy.has_param": _has_param,
    "rospy.set_param": _set_param,
    "rospy.search_param": _search_param,
    "rospy.get_param_cached": _get_param,
    "rospy.resolve_name": _resolve_name,
    "rospy.remap_name": _resolve_name,
    "rospy.names.resolve_name": _resolve_name,
    "rospy.names.ns_join": lambda machine, _, a: resolve(machine, a.get(1), a.get(0)),
    "rospy.get_name": _get_name,
    "rospy.get_namespace": _get_namespace,
    "roslib.message.get_message_class": _message_class,
    "rospy.is_shutdown": _not_shut_down,
    "rospy.Timer": _timer,
    "rospy.on_shutdown": _timer,
    "message_filters.Subscriber": partial(_endpoint, DeclarationKind.SUBSCRIBE),
    "actionlib.SimpleActionClient": partial(_action, DeclarationKind.ACTION_CLIENT),
    "actionlib.ActionClient": partial(_action, DeclarationKind.ACTION_CLIENT),
    "actionlib.SimpleActionServer": partial(_action, DeclarationKind.ACTION_SERVER),
    "actionlib.ActionServer": partial(_action, DeclarationKind.ACTION_SERVER),
    "dynamic_reconfigure.server.Server": _reconfigure,
    "dynamic_reconfigure.client.Client": _reconfigure_client,
    "tf.TransformListener": partial(_transforms, DeclarationKind.SUBSCRIBE),
    "tf.TransformBroadcaster": partial(_transforms, DeclarationKind.PUBLISH),
    "tf2_ros.TransformListener": partial(_transforms, DeclarationKind.SUBSCRIBE),
    "tf2_ros.TransformBroadcaster": partial(_transforms, DeclarationKind.PUBLISH),
    "tf2_ros.StaticTransformBroadcaster": partial(
        _transforms, DeclarationKind.PUBLISH, static=True
    ),
    "diagnostic_updater.Updater": _diagnostics,
    "diagnostic_updater.DiagnosticUpdater": _diagnostics,
    "bondpy.bondpy.Bond": _bond,
    "bondpy.Bond": _bond,
}
_SAME = {
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
    "rospy.timer.Timer": "rospy.Timer",
    "rospy.rostime.Timer": "rospy.Timer",
    "roslib.message.get_service_class": "roslib.message.get_message_class",
}

PYTHON_ROS: dict[str, Value] = {
    **{name: Native(name, call) for name, call in _CALLS.items()},
    **{alias: Native(of, _CALLS[of]) for alias, of in _SAME.items()},
    "rospy.AnyMsg": MessageType("*"),
    "rospy.msg.AnyMsg": MessageType("*"),
}

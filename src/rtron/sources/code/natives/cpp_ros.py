"""The C++ libraries of ROS around roscpp, as far as they join nodes."""

import re
from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.arguments import Arguments
from rtron.sources.code.interpreter.machine import Machine
from rtron.sources.code.interpreter.values import (
    NONE,
    FunctionValue,
    Hole,
    Instance,
    Known,
    Native,
    NativeClass,
    Value,
    options,
    spelled,
)
from rtron.sources.code.natives import endpoints
from rtron.sources.code.natives.cpp import cpp
from rtron.sources.code.natives.names import node_namespace, parameter, remapped, resolve
from rtron.sources.code.natives.node_handle import (
    ENDPOINT,
    FUNCTIONS,
    NODE_HANDLE,
    OPTIONS,
    escape_all,
    handle,
    in_handle,
    message_of,
    private_handle,
    typed,
)
from rtron.sources.declaration import DeclarationKind

_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE
_UNKNOWN = Hole("?")


def _handle_in(machine: Machine, arguments: Arguments) -> Instance:
    """Return the node handle among the arguments, or the node's own."""
    for value in arguments.values:
        for option in options(value):
            if isinstance(option, Instance) and "namespace" in option.fields:
                return option
    return handle(Known(node_namespace(machine)))


def _texts(arguments: Arguments) -> list[Value]:
    """Return the arguments that are, or may be, names."""
    return [
        value
        for value in arguments.values
        if any(not isinstance(o, (Instance, FunctionValue)) for o in options(value))
        and not (isinstance(value, Known) and not isinstance(value.value, str))
    ]


def _no_options(_: Machine, arguments: Arguments) -> Value:
    return (
        Instance(OPTIONS, {"options": _UNKNOWN, "type": Known("")})
        if arguments
        else Hole("options")
    )


def _init_options(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`SubscribeOptions::init<T>(topic, queue, callback)`."""
    escape_all(machine, arguments)
    machine.trail.set(owner.fields, "options", arguments.get(0) or _UNKNOWN)
    machine.trail.set(owner.fields, "type", Known(typed(machine, arguments)))
    return owner


def _image_transport(machine: Machine, arguments: Arguments) -> Value:
    return Instance(_TRANSPORT, {"namespace": _handle_in(machine, arguments).fields["namespace"]})


def _advertise_image(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    name = in_handle(machine, owner, arguments.get(0))
    endpoints.image_publisher(machine, name, arguments)
    escape_all(machine, arguments)
    return Instance(ENDPOINT, {"name": remapped(machine, name)})


def _advertise_camera(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    made = _advertise_image(machine, owner, arguments)
    info = endpoints.camera_info(machine, in_handle(machine, owner, arguments.get(0)))
    endpoints.declare(machine, _PUBLISH, info, "sensor_msgs/CameraInfo", arguments)
    return made


def _subscribe_image(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    name = in_handle(machine, owner, arguments.get(0))
    endpoints.image_subscriber(machine, name, _hinted(machine, arguments), arguments)
    escape_all(machine, arguments)
    return Instance(ENDPOINT, {"name": remapped(machine, name)})


def _subscribe_camera(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    made = _subscribe_image(machine, owner, arguments)
    info = endpoints.camera_info(machine, in_handle(machine, owner, arguments.get(0)))
    endpoints.declare(machine, _SUBSCRIBE, info, "sensor_msgs/CameraInfo", arguments)
    return made


def _hints(machine: Machine, arguments: Arguments) -> Value:
    """`TransportHints(default, ros_hints, handle)`: the parameter `image_transport` decides."""
    default = next(iter(_texts(arguments)), Known("raw"))
    given = next(
        (v for v in arguments.values if isinstance(v, Instance) and "namespace" in v.fields), None
    )
    found = parameter(
        machine, in_handle(machine, given or private_handle(machine), Known("image_transport"))
    )
    chosen = default if found is None or isinstance(found, Hole) else found
    return Instance(_HINTS, {"transport": chosen})


def _hinted(machine: Machine, arguments: Arguments) -> Value:
    for value in arguments.values:
        if isinstance(value, Instance) and value.type is _HINTS:
            return value.fields["transport"]
    found = _hints(machine, Arguments(frame=arguments.frame))
    return found.fields["transport"] if isinstance(found, Instance) else Known("raw")


def _filter_subscriber(machine: Machine, arguments: Arguments) -> Value:
    """`message_filters::Subscriber<T>(handle, topic, queue)`, or later by `subscribe`."""
    made = Instance(_FILTER, {}, arguments.types)
    if len(arguments.values) > 1:
        _filter_subscribe(machine, made, arguments)
    return made


def _filter_subscribe(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    names = _texts(arguments)
    topic = in_handle(machine, _handle_in(machine, arguments), names[0] if names else None)
    type = message_of(machine, owner.types[0] if owner.types else None, arguments)
    endpoints.declare(machine, _SUBSCRIBE, topic, type, arguments)
    return owner


def _image_filter(machine: Machine, arguments: Arguments) -> Value:
    """`image_transport::SubscriberFilter(it, topic, queue, hints)`."""
    made = Instance(_IMAGE_FILTER)
    if len(arguments.values) > 1:
        _image_filter_subscribe(machine, made, arguments)
    return made


def _image_filter_subscribe(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    _subscribe_image(machine, _handle_in(machine, arguments), arguments.shifted(1))
    return owner


def _takes_callbacks(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    escape_all(machine, arguments)
    return owner


def _transforms(
    kind: DeclarationKind, machine: Machine, arguments: Arguments, *, static: bool = False
) -> Value:
    endpoints.transforms(machine, kind, arguments, static=static)
    return Instance(ENDPOINT)


def _action_server(machine: Machine, arguments: Arguments) -> Value:
    """`SimpleActionServer<T>([handle,] name, …)`."""
    return _action(DeclarationKind.ACTION_SERVER, machine, arguments)


def _action_client(machine: Machine, arguments: Arguments) -> Value:
    """`SimpleActionClient<T>([handle,] name, …)`."""
    return _action(DeclarationKind.ACTION_CLIENT, machine, arguments)


def _action(kind: DeclarationKind, machine: Machine, arguments: Arguments) -> Value:
    names = _texts(arguments)
    if names:
        name = in_handle(machine, _handle_in(machine, arguments), names[0])
        type = message_of(machine, arguments.types[0] if arguments.types else None, arguments)
        endpoints.declare(machine, kind, name, type, arguments)
    escape_all(machine, arguments)
    return Instance(_ACTION)


def _reconfigure(machine: Machine, arguments: Arguments) -> Value:
    """`dynamic_reconfigure::Server<T>([mutex,] handle)`; the node's private names by default."""
    given = [v for v in arguments.values if isinstance(v, Instance) and "namespace" in v.fields]
    owner = given[0] if given else private_handle(machine)
    endpoints.dynamic_reconfigure(machine, owner.fields["namespace"], arguments)
    return Instance(_RECONFIGURE)


def _diagnostics(machine: Machine, arguments: Arguments) -> Value:
    endpoints.diagnostics(machine, arguments)
    return Instance(_UPDATER)


def _bond(machine: Machine, arguments: Arguments) -> Value:
    names = _texts(arguments)
    endpoints.bond(machine, resolve(machine, names[0] if names else _UNKNOWN), arguments)
    return Instance(ENDPOINT)


def _nodelet_handle(machine: Machine, _: Value, __: Arguments) -> Value:
    return handle(Known(node_namespace(machine)))


def _nodelet_private_handle(machine: Machine, _: Value, __: Arguments) -> Value:
    return private_handle(machine)


def _nodelet_name(machine: Machine, _: Value, __: Arguments) -> Value:
    return Known(machine.recorder.site.name)


def _loader(_: Machine, arguments: Arguments) -> Value:
    """`pluginlib::ClassLoader<Base>(package, base)`."""
    return Instance(_LOADER, {"base": arguments.get(1) or _UNKNOWN}, arguments.types)


def _create_instance(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`loader.createInstance(name)`: the plugin's class, made from its source."""
    base = owner.fields.get("base", _UNKNOWN)
    for option in options(arguments.get(0)):
        if isinstance(option, Known) and isinstance(base, Known):
            made = cpp(machine).plugin(str(option.value), str(base.value), arguments)
            if made is not None:
                return made
        what = f"plugin {spelled(option)}"
        machine.recorder.unresolved(what, "its source is not found", arguments.evidence)
    return Hole("plugin")


def _plugin_name(_: Machine, __: Instance, arguments: Arguments) -> Value:
    """`loader.getName("pkg::Class")` is its last part."""
    name = arguments.get(0)
    if not isinstance(name, Known):
        return Hole("name")
    return Known(re.split("::|/", str(name.value))[-1])


def _available(_: Machine, __: Instance, ___: Arguments) -> Value:
    return Hole("isClassAvailable")


def _camera_info_manager(machine: Machine, arguments: Arguments) -> Value:
    """`CameraInfoManager(handle, …)` offers set_camera_info (ROS wiki: camera_info_manager)."""
    owner = _handle_in(machine, arguments)
    name = in_handle(machine, owner, Known("set_camera_info"))
    kind, type = DeclarationKind.SERVICE, "sensor_msgs/SetCameraInfo"
    endpoints.declare(machine, kind, name, type, arguments, implicit=True)
    return Instance(_CAMERA_INFO)


def _realtime_publisher(machine: Machine, arguments: Arguments) -> Value:
    """`realtime_tools::RealtimePublisher<T>(handle, topic, queue, latched)`."""
    topic = in_handle(machine, _handle_in(machine, arguments), arguments.get(1))
    type = message_of(machine, arguments.types[0] if arguments.types else None, arguments)
    endpoints.declare(machine, _PUBLISH, topic, type, arguments)
    return Instance(ENDPOINT, {"name": remapped(machine, topic)})


def _marker_server(machine: Machine, arguments: Arguments) -> Value:
    """`InteractiveMarkerServer(topic_ns)` (ROS wiki: interactive_markers)."""
    base = resolve(machine, arguments.get(0) or _UNKNOWN)
    for kind, name, type in (
        (_PUBLISH, "update", "visualization_msgs/InteractiveMarkerUpdate"),
        (_PUBLISH, "update_full", "visualization_msgs/InteractiveMarkerInit"),
        (_SUBSCRIBE, "feedback", "visualization_msgs/InteractiveMarkerFeedback"),
    ):
        endpoints.declare(
            machine, kind, endpoints.below(base, name), type, arguments, implicit=True
        )
    return Instance(ENDPOINT)


def _shape_shifter(machine: Machine, _: Value, arguments: Arguments) -> Value:
    """`ShapeShifter::advertise(handle, topic, queue)`: any message type."""
    topic = in_handle(machine, _handle_in(machine, arguments), arguments.get(1))
    endpoints.declare(machine, _PUBLISH, topic, "*", arguments)
    return Instance(ENDPOINT, {"name": remapped(machine, topic)})


def _controller_manager(machine: Machine, arguments: Arguments) -> Value:
    """`ControllerManager(robot, handle)` (ROS wiki: controller_manager)."""
    base = in_handle(machine, _handle_in(machine, arguments), Known("controller_manager"))
    for name, type in _MANAGER_SERVICES.items():
        kind, service = DeclarationKind.SERVICE, endpoints.below(base, name)
        endpoints.declare(machine, kind, service, f"controller_manager_msgs/{type}", arguments)
    return Instance(ENDPOINT)


def _nodelet_loader(_: Machine, __: Arguments) -> Value:
    return Instance(_NODELET_LOADER)


_MANAGER_SERVICES = {
    "list_controllers": "ListControllers",
    "list_controller_types": "ListControllerTypes",
    "load_controller": "LoadController",
    "unload_controller": "UnloadController",
    "switch_controller": "SwitchController",
    "reload_controller_libraries": "ReloadControllerLibraries",
}
_TRANSPORT = NativeClass(
    "image_transport::ImageTransport",
    _image_transport,
    {
        "advertise": _advertise_image,
        "advertiseCamera": _advertise_camera,
        "subscribe": _subscribe_image,
        "subscribeCamera": _subscribe_camera,
    },
)
_HINTS = NativeClass("image_transport::TransportHints", _hints)
_FILTER = NativeClass(
    "message_filters::Subscriber",
    _filter_subscriber,
    {"subscribe": _filter_subscribe, "registerCallback": _takes_callbacks},
)
_IMAGE_FILTER = NativeClass(
    "image_transport::SubscriberFilter",
    _image_filter,
    {"subscribe": _image_filter_subscribe, "registerCallback": _takes_callbacks},
)
_SYNCHRONIZER = NativeClass(
    "message_filters::Synchronizer", methods={"registerCallback": _takes_callbacks}
)
_ACTION = NativeClass(
    "actionlib",
    methods=dict.fromkeys(
        ("registerGoalCallback", "registerPreemptCallback", "sendGoal", "registerCancelCallback"),
        _takes_callbacks,
    ),
)
_RECONFIGURE = NativeClass(
    "dynamic_reconfigure::Server", _reconfigure, {"setCallback": _takes_callbacks}
)
_UPDATER = NativeClass("diagnostic_updater::Updater", _diagnostics, {"add": _takes_callbacks})
_CAMERA_INFO = NativeClass("camera_info_manager::CameraInfoManager", _camera_info_manager)
_LOADER = NativeClass(
    "pluginlib::ClassLoader",
    _loader,
    {
        **dict.fromkeys(
            (
                "createInstance",
                "createClassInstance",
                "createUnmanagedInstance",
                "createUniqueInstance",
            ),
            _create_instance,
        ),
        "getName": _plugin_name,
        "isClassAvailable": _available,
        "isClassLoaded": _available,
    },
)
_NODELET = NativeClass(
    "nodelet::Nodelet",
    methods={
        **dict.fromkeys(("getNodeHandle", "getMTNodeHandle"), _nodelet_handle),
        **dict.fromkeys(
            ("getPrivateNodeHandle", "getMTPrivateNodeHandle"), _nodelet_private_handle
        ),
        "getName": _nodelet_name,
    },
)
_SHAPE_SHIFTER = NativeClass("topic_tools::ShapeShifter", methods={"advertise": _shape_shifter})
_NODELET_LOADER = NativeClass("nodelet::Loader", _nodelet_loader)

_POINTER = NativeClass("pointer", lambda machine, arguments: arguments.get(0) or NONE)
_RECEIVE = partial(_transforms, _SUBSCRIBE)
_SEND = partial(_transforms, _PUBLISH)
_SEND_STATIC = partial(_transforms, _PUBLISH, static=True)

_MADE: Mapping[str, Callable[..., Value]] = {
    **dict.fromkeys(("tf::TransformListener", "tf2_ros::TransformListener"), _RECEIVE),
    **dict.fromkeys(("tf::TransformBroadcaster", "tf2_ros::TransformBroadcaster"), _SEND),
    "tf2_ros::StaticTransformBroadcaster": _SEND_STATIC,
    "actionlib::SimpleActionServer": _action_server,
    "actionlib::ActionServer": _action_server,
    "actionlib::SimpleActionClient": _action_client,
    "actionlib::ActionClient": _action_client,
    "bond::Bond": _bond,
    "controller_manager::ControllerManager": _controller_manager,
    "realtime_tools::RealtimePublisher": _realtime_publisher,
    "interactive_markers::InteractiveMarkerServer": _marker_server,
    "ros::AdvertiseOptions": _no_options,
    "ros::SubscribeOptions": _no_options,
    "ros::AdvertiseServiceOptions": _no_options,
    "ros::ServiceClientOptions": _no_options,
}
_SYNCHRONIZERS = (
    "message_filters::Synchronizer",
    "message_filters::TimeSynchronizer",
    "tf::MessageFilter",
    "tf2_ros::MessageFilter",
    "message_filters::Cache",
)
CPP_ROS_CLASSES: dict[str, NativeClass] = {
    **{name: NativeClass(name, make) for name, make in _MADE.items()},
    **{name: NativeClass(name, None, dict(_SYNCHRONIZER.methods)) for name in _SYNCHRONIZERS},
    **{
        native.name: native
        for native in (
            NODE_HANDLE,
            _TRANSPORT,
            _HINTS,
            _FILTER,
            _IMAGE_FILTER,
            _RECONFIGURE,
            _UPDATER,
            _CAMERA_INFO,
            _LOADER,
            _NODELET,
            _NODELET_LOADER,
        )
    },
    **dict.fromkeys(("ros::Publisher", "ros::Subscriber", "ros::ServiceServer"), ENDPOINT),
    **dict.fromkeys(("ros::ServiceClient", "ros::Timer", "ros::WallTimer"), ENDPOINT),
    **dict.fromkeys(("image_transport::Publisher", "image_transport::Subscriber"), ENDPOINT),
    **dict.fromkeys(
        ("image_transport::CameraPublisher", "image_transport::CameraSubscriber"), ENDPOINT
    ),
    **dict.fromkeys(("ros::NodeHandlePtr", "ros::NodeHandleConstPtr"), _POINTER),
    "nodelet_topic_tools::NodeletLazy": _NODELET,
    "CameraInfoManager": _CAMERA_INFO,
    "topic_tools::ShapeShifter": _SHAPE_SHIFTER,
}
CPP_ROS_FUNCTIONS = {name: Native(name, call) for name, call in FUNCTIONS.items()}
OPTIONS.methods.update(init=_init_options, initByFullCallbackType=_init_options)

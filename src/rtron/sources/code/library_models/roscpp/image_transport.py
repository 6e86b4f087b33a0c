"""image_transport, and the calibration that camera drivers offer (ROS wiki)."""

from rtron.sources.code.interpreter.abstract_values.value_types import (
    Hole,
    Instance,
    Known,
    NativeClass,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp_arguments import (
    escape_all,
    in_handle,
    take_callbacks,
    texts,
)
from rtron.sources.code.library_models.ros1_common import endpoints
from rtron.sources.code.library_models.ros1_common.names import parameter, remapped
from rtron.sources.code.library_models.roscpp.node_handle import (
    ENDPOINT,
    given_handle,
    handle_among,
    private_handle,
)
from rtron.sources.declaration import DeclarationKind

_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE


def _image_transport(machine: Machine, arguments: Arguments) -> Value:
    return Instance(_TRANSPORT, {"namespace": handle_among(machine, arguments).fields["namespace"]})


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
    default = next(iter(texts(arguments)), Known("raw"))
    owner = given_handle(arguments) or private_handle(machine)
    found = parameter(machine, in_handle(machine, owner, Known("image_transport")))
    chosen = default if found is None or isinstance(found, Hole) else found
    return Instance(_HINTS, {"transport": chosen})


def _hinted(machine: Machine, arguments: Arguments) -> Value:
    for value in arguments.values:
        if isinstance(value, Instance) and value.type is _HINTS:
            return value.fields["transport"]
    found = _hints(machine, Arguments(frame=arguments.frame))
    return found.fields["transport"] if isinstance(found, Instance) else Known("raw")


def _image_filter(machine: Machine, arguments: Arguments) -> Value:
    """`image_transport::SubscriberFilter(it, topic, queue, hints)`."""
    made = Instance(_IMAGE_FILTER)
    if len(arguments.values) > 1:
        _image_filter_subscribe(machine, made, arguments)
    return made


def _image_filter_subscribe(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    _subscribe_image(machine, handle_among(machine, arguments), arguments.shifted(1))
    return owner


def _camera_info_manager(machine: Machine, arguments: Arguments) -> Value:
    """`CameraInfoManager(handle, …)` offers set_camera_info (ROS wiki: camera_info_manager)."""
    owner = handle_among(machine, arguments)
    name = in_handle(machine, owner, Known("set_camera_info"))
    kind, type = DeclarationKind.SERVICE, "sensor_msgs/SetCameraInfo"
    endpoints.declare(machine, kind, name, type, arguments, implicit=True)
    return Instance(_CAMERA_INFO)


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
_IMAGE_FILTER = NativeClass(
    "image_transport::SubscriberFilter",
    _image_filter,
    {"subscribe": _image_filter_subscribe, "registerCallback": take_callbacks},
)
_CAMERA_INFO = NativeClass("camera_info_manager::CameraInfoManager", _camera_info_manager)

IMAGE_CLASSES = {
    **{native.name: native for native in (_TRANSPORT, _HINTS, _IMAGE_FILTER, _CAMERA_INFO)},
    **dict.fromkeys(("image_transport::Publisher", "image_transport::Subscriber"), ENDPOINT),
    **dict.fromkeys(
        ("image_transport::CameraPublisher", "image_transport::CameraSubscriber"), ENDPOINT
    ),
    "CameraInfoManager": _CAMERA_INFO,
}

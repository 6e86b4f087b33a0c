"""image_transport: images, and the camera's info beside them (ROS wiki)."""

from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common import cpp_arguments
from rtron.sources.code.library_models.ros1_common import endpoints
from rtron.sources.code.library_models.ros1_common.names import parameter_value, remap_name
from rtron.sources.code.library_models.roscpp.node_handle import (
    ENDPOINT,
    handle_argument,
    handle_argument_or_default,
    private_handle,
)
from rtron.sources.declaration import DeclarationKind

_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE


def _image_transport(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    owner = handle_argument_or_default(machine, arguments)
    return av.Instance(_TRANSPORT, {"namespace": owner.fields["namespace"]})


def _advertise_image(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    name = cpp_arguments.resolve_in_handle(machine, owner, arguments.get(0))
    endpoints.declare_image_publisher(machine, name, arguments)
    cpp_arguments.escape_functions(machine, arguments)
    return av.Instance(ENDPOINT, {"name": remap_name(machine, name)})


def _declare_camera(
    kind: DeclarationKind, machine: AbstractMachine, owner: av.Value, arguments: Arguments
) -> av.Value:
    """`advertiseCamera(…)`, `subscribeCamera(…)`: an image, and the camera's info beside it."""
    made = (_advertise_image if kind is _PUBLISH else _subscribe_image)(machine, owner, arguments)
    info = endpoints.camera_info_topic(
        machine, cpp_arguments.resolve_in_handle(machine, owner, arguments.get(0))
    )
    endpoints.declare_endpoint(machine, kind, info, "sensor_msgs/CameraInfo", arguments)
    return made


def _subscribe_image(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    name = cpp_arguments.resolve_in_handle(machine, owner, arguments.get(0))
    transport = _hinted_transport(machine, arguments)
    endpoints.declare_image_subscriber(machine, name, transport, arguments)
    cpp_arguments.escape_functions(machine, arguments)
    return av.Instance(ENDPOINT, {"name": remap_name(machine, name)})


def _make_transport_hints(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`TransportHints(default, ros_hints, handle)`: the parameter `image_transport` decides."""
    default = next(iter(cpp_arguments.name_arguments(arguments)), av.Scalar("raw"))
    owner = handle_argument(arguments) or private_handle(machine)
    found = parameter_value(
        machine, cpp_arguments.resolve_in_handle(machine, owner, av.Scalar("image_transport"))
    )
    chosen = default if found is None or isinstance(found, av.Unknown) else found
    return av.Instance(_HINTS, {"transport": chosen})


def _hinted_transport(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    for value in arguments.values:
        if isinstance(value, av.Instance) and value.type is _HINTS:
            return value.fields["transport"]
    found = _make_transport_hints(machine, arguments.with_values())
    return found.fields["transport"] if isinstance(found, av.Instance) else av.Scalar("raw")


def _image_filter(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`image_transport::SubscriberFilter(it, topic, queue, hints)`."""
    made = av.Instance(_IMAGE_FILTER)
    if len(arguments.values) > 1:
        _filter_images(machine, made, arguments)
    return made


def _filter_images(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    _subscribe_image(
        machine, handle_argument_or_default(machine, arguments), arguments.without_first(1)
    )
    return owner


_TRANSPORT = av.LibraryClass(
    "image_transport::ImageTransport",
    _image_transport,
    {
        "advertise": _advertise_image,
        "advertiseCamera": partial(_declare_camera, _PUBLISH),
        "subscribe": _subscribe_image,
        "subscribeCamera": partial(_declare_camera, _SUBSCRIBE),
    },
)
_HINTS = av.LibraryClass("image_transport::TransportHints", _make_transport_hints)
_IMAGE_FILTER = av.LibraryClass(
    "image_transport::SubscriberFilter",
    _image_filter,
    {"subscribe": _filter_images, "registerCallback": cpp_arguments.register_callbacks},
)

IMAGE_CLASSES = {
    **{cls.name: cls for cls in (_TRANSPORT, _HINTS, _IMAGE_FILTER)},
    **dict.fromkeys(("image_transport::Publisher", "image_transport::Subscriber"), ENDPOINT),
    **dict.fromkeys(
        ("image_transport::CameraPublisher", "image_transport::CameraSubscriber"), ENDPOINT
    ),
}

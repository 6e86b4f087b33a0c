"""image_transport of ROS 2, and point_cloud_transport (docs.ros.org)."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import (
    TRUE,
    UNKNOWN,
    FunctionValue,
    Instance,
    LibraryClass,
    Scalar,
    Unknown,
    Value,
    concat,
    is_text,
    map_options,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp_arguments import (
    escape_functions,
    register_callbacks,
)
from rtron.sources.code.library_models.rclcpp.endpoints import (
    ENDPOINT,
    qos_argument,
    split_node_argument,
)
from rtron.sources.code.library_models.ros2_common import endpoints
from rtron.sources.code.library_models.ros2_common.names import name_below, namespace_of
from rtron.sources.code.library_models.ros2_common.nodes import first_node, resolve_at_node
from rtron.sources.code.library_models.ros2_common.qos import DEFAULT_QOS, read_qos
from rtron.sources.declaration import DeclarationKind
from rtron.vocabulary import QoS

TRANSPORTS = {
    "compressed": "sensor_msgs/msg/CompressedImage",
    "compressedDepth": "sensor_msgs/msg/CompressedImage",
    "theora": "theora_image_transport/msg/Packet",
    "zstd": "sensor_msgs/msg/CompressedImage",
}
_IMAGE, _INFO = "sensor_msgs/msg/Image", "sensor_msgs/msg/CameraInfo"
_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE


def _create_image_endpoint(
    kind: DeclarationKind,
    machine: AbstractMachine,
    owner: Value,
    arguments: Arguments,
    *,
    camera: bool = False,
    type: str = _IMAGE,
) -> Value:
    node, rest = split_node_argument(owner, arguments)
    escape_functions(machine, rest)
    name = rest.get(0)
    if node is None:
        endpoints.note_unknown_node(machine, f"image_transport {kind.value}", name, rest)
        return Unknown("image")
    chosen = _chosen_transport(rest) if kind is _SUBSCRIBE else "raw"
    image, qos = resolve_at_node(node, name), _image_qos(rest)
    if chosen in TRANSPORTS:
        name, type = concat((name or UNKNOWN, Scalar(f"/{chosen}"))), TRANSPORTS[chosen]
    endpoints.declare_endpoint(machine, kind, node, name, type, rest, qos=qos)
    if kind is _PUBLISH and type == _IMAGE:
        _declare_transports(machine, node, image, rest, qos)
    if camera:
        info = map_options(image, lambda one: name_below(namespace_of(one), Scalar("camera_info")))
        endpoints.declare_endpoint(machine, kind, node, info, _INFO, rest, qos=qos)
    return Instance(ENDPOINT, {"name": image, "truth": TRUE})


def _image_qos(rest: Arguments) -> QoS | None:
    """Return what all that is made has; without any given it is rmw's default.

    What is not known among the arguments may be one. So may a latch, which the versions of
    image_transport do not take for the same.
    """
    given = qos_argument(rest)
    if TRUE in rest.values or given is not None:
        return None if TRUE in rest.values else read_qos(given)
    known = all(isinstance(v, FunctionValue) or is_text(v) for v in rest.values[1:])
    return DEFAULT_QOS if known else None


def _declare_transports(
    machine: AbstractMachine, node: Instance, image: Value, at: Arguments, qos: QoS | None
) -> None:
    for transport, type in TRANSPORTS.items():
        topic = name_below(image, Scalar(transport))
        endpoints.declare_endpoint(machine, _PUBLISH, node, topic, type, at, qos=qos, implicit=True)


def _chosen_transport(rest: Arguments) -> str:
    """Return the transport that a subscription is made with: a text behind the callback."""
    found = (v for v in rest.values[1:] if isinstance(v, Scalar) and is_text(v))
    return str(next(found, Scalar("raw")).value)


def _image_transport(_: AbstractMachine, arguments: Arguments) -> Value:
    """`image_transport::ImageTransport(node)`."""
    node = first_node(arguments.values)
    return Instance(_TRANSPORT, dict(node.fields) if node is not None else {})


def _cloud_transport(_: AbstractMachine, arguments: Arguments) -> Value:
    """`point_cloud_transport::PointCloudTransport(node)`."""
    node = first_node(arguments.values)
    return Instance(_CLOUD_TRANSPORT, dict(node.fields) if node is not None else {})


def _make_filter(machine: AbstractMachine, arguments: Arguments) -> Value:
    """`image_transport::SubscriberFilter(node, topic, transport)`."""
    made = Instance(_FILTER, {"truth": TRUE})
    if arguments.values:
        _create_image_endpoint(_SUBSCRIBE, machine, Scalar(None), arguments)
    return made


def _filter_subscribe(machine: AbstractMachine, owner: Value, arguments: Arguments) -> Value:
    _create_image_endpoint(_SUBSCRIBE, machine, Scalar(None), arguments)
    return owner


_ENDPOINT_FACTORIES: Mapping[str, Callable[..., Value]] = {
    "publisher": partial(_create_image_endpoint, _PUBLISH),
    "subscription": partial(_create_image_endpoint, _SUBSCRIBE),
    "camera_publisher": partial(_create_image_endpoint, _PUBLISH, camera=True),
    "camera_subscription": partial(_create_image_endpoint, _SUBSCRIBE, camera=True),
}
_TRANSPORT = LibraryClass(
    "image_transport::ImageTransport",
    _image_transport,
    {
        "advertise": _ENDPOINT_FACTORIES["publisher"],
        "advertiseCamera": _ENDPOINT_FACTORIES["camera_publisher"],
        "subscribe": _ENDPOINT_FACTORIES["subscription"],
        "subscribeCamera": _ENDPOINT_FACTORIES["camera_subscription"],
    },
)
_CLOUD = "sensor_msgs/msg/PointCloud2"
_CLOUD_TRANSPORT = LibraryClass(
    "point_cloud_transport::PointCloudTransport",
    _cloud_transport,
    {
        "advertise": partial(_create_image_endpoint, _PUBLISH, type=_CLOUD),
        "subscribe": partial(_create_image_endpoint, _SUBSCRIBE, type=_CLOUD),
    },
)
_FILTER = LibraryClass(
    "image_transport::SubscriberFilter",
    _make_filter,
    {"subscribe": _filter_subscribe, "registerCallback": register_callbacks},
)
IMAGE_CLASSES: Mapping[str, LibraryClass] = {
    cls.name: cls for cls in (_TRANSPORT, _CLOUD_TRANSPORT, _FILTER)
}
IMAGE_FUNCTIONS: Mapping[str, Callable[..., Value]] = {
    f"image_transport::create_{sort}": call for sort, call in _ENDPOINT_FACTORIES.items()
}

"""image_transport of ROS 2, and point_cloud_transport (docs.ros.org)."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import (
    TRUE,
    FunctionValue,
    Hole,
    Instance,
    Known,
    NativeClass,
    Value,
    concat,
    each,
    is_text,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp_arguments import escape_all, take_callbacks
from rtron.sources.code.library_models.rclcpp.endpoints import ENDPOINT, given_qos, owned
from rtron.sources.code.library_models.ros2_common import endpoints
from rtron.sources.code.library_models.ros2_common.names import below, namespace_of
from rtron.sources.code.library_models.ros2_common.nodes import node_among, resolved
from rtron.sources.code.library_models.ros2_common.qos import DEFAULT, qos_of
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


def _endpoint(
    kind: DeclarationKind,
    machine: Machine,
    owner: Value,
    arguments: Arguments,
    *,
    camera: bool = False,
    type: str = _IMAGE,
) -> Value:
    node, rest = owned(owner, arguments)
    escape_all(machine, rest)
    name = rest.get(0)
    if node is None:
        endpoints.unknown_owner(machine, f"image_transport {kind.value}", name, rest)
        return Hole("image")
    chosen = _transport(rest) if kind is _SUBSCRIBE else "raw"
    image, qos = resolved(node, name), _quality(rest)
    if chosen in TRANSPORTS:
        name, type = concat((name or Hole("?"), Known(f"/{chosen}"))), TRANSPORTS[chosen]
    endpoints.declare(machine, kind, node, name, type, rest, qos=qos)
    if kind is _PUBLISH and type == _IMAGE:
        _transports(machine, node, image, rest, qos)
    if camera:
        info = each(image, lambda one: below(namespace_of(one), Known("camera_info")))
        endpoints.declare(machine, kind, node, info, _INFO, rest, qos=qos)
    return Instance(ENDPOINT, {"name": image, "truth": TRUE})


def _quality(rest: Arguments) -> QoS | None:
    """Return what all that is made has; without any given it is rmw's default.

    What is not known among the arguments may be one. So may a latch, which the versions of
    image_transport do not take for the same.
    """
    given = given_qos(rest)
    if TRUE in rest.values or given is not None:
        return None if TRUE in rest.values else qos_of(given)
    known = all(isinstance(v, FunctionValue) or is_text(v) for v in rest.values[1:])
    return DEFAULT if known else None


def _transports(
    machine: Machine, node: Instance, image: Value, at: Arguments, qos: QoS | None
) -> None:
    for transport, type in TRANSPORTS.items():
        topic = below(image, Known(transport))
        endpoints.declare(machine, _PUBLISH, node, topic, type, at, qos=qos, implicit=True)


def _transport(rest: Arguments) -> str:
    """Return the transport that a subscription is made with: a text behind the callback."""
    found = (v for v in rest.values[1:] if isinstance(v, Known) and is_text(v))
    return str(next(found, Known("raw")).value)


def _image_transport(_: Machine, arguments: Arguments) -> Value:
    """`image_transport::ImageTransport(node)`."""
    node = node_among(arguments.values)
    return Instance(_TRANSPORT, dict(node.fields) if node is not None else {})


def _cloud_transport(_: Machine, arguments: Arguments) -> Value:
    """`point_cloud_transport::PointCloudTransport(node)`."""
    node = node_among(arguments.values)
    return Instance(_CLOUDS, dict(node.fields) if node is not None else {})


def _filter(machine: Machine, arguments: Arguments) -> Value:
    """`image_transport::SubscriberFilter(node, topic, transport)`."""
    made = Instance(_FILTER, {"truth": TRUE})
    if arguments.values:
        _endpoint(_SUBSCRIBE, machine, Known(None), arguments)
    return made


def _filter_subscribe(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    _endpoint(_SUBSCRIBE, machine, Known(None), arguments)
    return owner


_SORTS: Mapping[str, Callable[..., Value]] = {
    "publisher": partial(_endpoint, _PUBLISH),
    "subscription": partial(_endpoint, _SUBSCRIBE),
    "camera_publisher": partial(_endpoint, _PUBLISH, camera=True),
    "camera_subscription": partial(_endpoint, _SUBSCRIBE, camera=True),
}
_TRANSPORT = NativeClass(
    "image_transport::ImageTransport",
    _image_transport,
    {
        "advertise": _SORTS["publisher"],
        "advertiseCamera": _SORTS["camera_publisher"],
        "subscribe": _SORTS["subscription"],
        "subscribeCamera": _SORTS["camera_subscription"],
    },
)
_CLOUD = "sensor_msgs/msg/PointCloud2"
_CLOUDS = NativeClass(
    "point_cloud_transport::PointCloudTransport",
    _cloud_transport,
    {
        "advertise": partial(_endpoint, _PUBLISH, type=_CLOUD),
        "subscribe": partial(_endpoint, _SUBSCRIBE, type=_CLOUD),
    },
)
_FILTER = NativeClass(
    "image_transport::SubscriberFilter",
    _filter,
    {"subscribe": _filter_subscribe, "registerCallback": take_callbacks},
)
IMAGE_CLASSES: Mapping[str, NativeClass] = {
    native.name: native for native in (_TRANSPORT, _CLOUDS, _FILTER)
}
IMAGE_FUNCTIONS: Mapping[str, Callable[..., Value]] = {
    f"image_transport::create_{sort}": call for sort, call in _SORTS.items()
}

"""image_transport of ROS 2, and point_cloud_transport.

Sources: docs.ros.org; image_common, image_transport.cpp; point_cloud_transport,
point_cloud_transport.hpp.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from itertools import chain

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp_arguments import (
    escape_functions,
    register_callbacks,
)
from rtron.sources.code.library_models.common.trivial_functions import returning_field
from rtron.sources.code.library_models.rclcpp.endpoints import (
    ENDPOINT,
    qos_argument,
    split_node,
)
from rtron.sources.code.library_models.ros2_common import endpoints
from rtron.sources.code.library_models.ros2_common.names import name_below, namespace_of
from rtron.sources.code.library_models.ros2_common.nodes import first_node, resolve_at_node
from rtron.sources.code.library_models.ros2_common.parameters import (
    node_parameter_value,
    value_or_default,
)
from rtron.sources.code.library_models.ros2_common.qos import (
    DEFAULT_QOS,
    QOS_PROFILES,
    read_qos,
)
from rtron.sources.declaration import DeclarationKind
from rtron.vocabulary import QoS

TRANSPORTS = {
    "compressed": "sensor_msgs/msg/CompressedImage",
    "compressedDepth": "sensor_msgs/msg/CompressedImage",
    "theora": "theora_image_transport/msg/Packet",
    "zstd": "sensor_msgs/msg/CompressedImage",
}
CLOUD_TRANSPORTS = dict.fromkeys(
    ("draco", "zlib", "zstd", "cloudini"), "point_cloud_interfaces/msg/CompressedPointCloud2"
)
_PARAMETER = av.Scalar("image_transport")
_IMAGE, _INFO = "sensor_msgs/msg/Image", "sensor_msgs/msg/CameraInfo"
_CLOUD = "sensor_msgs/msg/PointCloud2"
_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE


def _create_image_endpoint(
    kind: DeclarationKind,
    machine: AbstractMachine,
    owner: av.Value,
    arguments: Arguments,
    *,
    camera: bool = False,
    type: str = _IMAGE,
) -> av.Value:
    node, rest = split_node(owner, arguments)
    escape_functions(machine, rest)
    name = rest.get(0)
    if node is None:
        endpoints.note_unknown_node(machine, f"image_transport {kind.value}", name, rest)
        return av.Unknown("image")
    chosen = _chosen_transport(machine, node, rest) if kind is _SUBSCRIBE else "raw"
    image, qos = resolve_at_node(node, name), _transport_qos(rest, type)
    known = TRANSPORTS if type == _IMAGE else CLOUD_TRANSPORTS
    if chosen in known:
        name, type = av.concat((name or av.UNKNOWN, av.Scalar(f"/{chosen}"))), known[chosen]
    endpoints.declare_endpoint(machine, kind, node, name, type, rest, qos=qos)
    if kind is _PUBLISH and type == _IMAGE:
        _declare_transports(machine, node, image, rest, qos)
    if camera:
        info = av.map_options(
            image, lambda one: name_below(namespace_of(one), av.Scalar("camera_info"))
        )
        endpoints.declare_endpoint(machine, kind, node, info, _INFO, rest, qos=qos)
    return av.Instance(ENDPOINT, {"name": image, "truth": av.TRUE})


def _transport_qos(rest: Arguments, type: str) -> QoS | None:
    """Return what all that is made has; without any given it is rmw's default.

    A queue's length is one of clouds as a sensor has it. What is not known among the arguments may
    be one. So may a latch, which the versions of image_transport do not take for the same.
    """
    given = qos_argument(rest)
    read = read_qos(given) if type == _CLOUD and isinstance(given, av.Scalar) else None
    if read is not None:
        return replace(QOS_PROFILES["sensor_data"], depth=read.depth)
    if av.TRUE in rest.values or given is not None:
        return None if av.TRUE in rest.values else read_qos(given)
    known = all(isinstance(v, av.FunctionValue) or av.is_text(v) for v in rest.values[1:])
    return DEFAULT_QOS if known else None


def _declare_transports(
    machine: AbstractMachine, node: av.Instance, image: av.Value, at: Arguments, qos: QoS | None
) -> None:
    for transport, type in TRANSPORTS.items():
        topic = name_below(image, av.Scalar(transport))
        endpoints.declare_endpoint(machine, _PUBLISH, node, topic, type, at, qos=qos, implicit=True)


def _chosen_transport(machine: AbstractMachine, node: av.Instance, rest: Arguments) -> str:
    """Return the transport of a subscription: a text behind the callback, or hints.

    Without either it is the node's parameter, if it has one (image_transport: TransportHints).
    """
    given = rest.values[1:]
    hints = (
        v.fields["transport"] for v in given if isinstance(v, av.Instance) and v.type is _HINTS
    )
    texts = (v for v in given if isinstance(v, av.Scalar) and av.is_text(v))
    chosen = next(chain(hints, texts), None) or _hinted_transport(machine, node, av.Scalar("raw"))
    known = (option for option in av.options(chosen) if isinstance(option, av.Scalar))
    return str(next(known, av.Scalar("raw")).value)


def _hinted_transport(
    machine: AbstractMachine, node: av.Value, default: av.Value, parameter: av.Value = _PARAMETER
) -> av.Value:
    return value_or_default(node_parameter_value(machine, node, parameter), default)


def _make_hints(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`TransportHints(node, default, parameter)`."""
    node, rest = split_node(av.Scalar(None), arguments)
    default, parameter = rest.get(0) or av.Scalar("raw"), rest.get(1) or _PARAMETER
    chosen = _hinted_transport(machine, node, default, parameter) if node else default
    return av.Instance(_HINTS, {"transport": chosen, "truth": av.TRUE})


def _image_transport(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """`image_transport::ImageTransport(node)`."""
    node = first_node(arguments.values)
    return av.Instance(_TRANSPORT, dict(node.fields) if node is not None else {})


def _cloud_transport(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """`point_cloud_transport::PointCloudTransport(node)`."""
    node = first_node(arguments.values)
    return av.Instance(_CLOUD_TRANSPORT, dict(node.fields) if node is not None else {})


def _make_filter(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`image_transport::SubscriberFilter(node, topic, transport)`."""
    made = av.Instance(_FILTER, {"truth": av.TRUE})
    if arguments.values:
        _create_image_endpoint(_SUBSCRIBE, machine, av.Scalar(None), arguments)
    return made


def _filter_subscribe(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    _create_image_endpoint(_SUBSCRIBE, machine, av.Scalar(None), arguments)
    return owner


_ENDPOINT_FACTORIES: Mapping[str, Callable[..., av.Value]] = {
    "publisher": partial(_create_image_endpoint, _PUBLISH),
    "subscription": partial(_create_image_endpoint, _SUBSCRIBE),
    "camera_publisher": partial(_create_image_endpoint, _PUBLISH, camera=True),
    "camera_subscription": partial(_create_image_endpoint, _SUBSCRIBE, camera=True),
}
_TRANSPORT = av.LibraryClass(
    "image_transport::ImageTransport",
    _image_transport,
    {
        "advertise": _ENDPOINT_FACTORIES["publisher"],
        "advertiseCamera": _ENDPOINT_FACTORIES["camera_publisher"],
        "subscribe": _ENDPOINT_FACTORIES["subscription"],
        "subscribeCamera": _ENDPOINT_FACTORIES["camera_subscription"],
    },
)
_CLOUD_TRANSPORT = av.LibraryClass(
    "point_cloud_transport::PointCloudTransport",
    _cloud_transport,
    {
        "advertise": partial(_create_image_endpoint, _PUBLISH, type=_CLOUD),
        "subscribe": partial(_create_image_endpoint, _SUBSCRIBE, type=_CLOUD),
    },
)
_FILTER = av.LibraryClass(
    "image_transport::SubscriberFilter",
    _make_filter,
    {"subscribe": _filter_subscribe, "registerCallback": register_callbacks},
)
_HINTS = av.LibraryClass(
    "image_transport::TransportHints", _make_hints, {"getTransport": returning_field("transport")}
)
IMAGE_CLASSES: Mapping[str, av.LibraryClass] = {
    **{cls.name: cls for cls in (_TRANSPORT, _CLOUD_TRANSPORT, _FILTER, _HINTS)},
    "point_cloud_transport::TransportHints": _HINTS,
}
IMAGE_FUNCTIONS: Mapping[str, Callable[..., av.Value]] = {
    **{f"image_transport::create_{sort}": call for sort, call in _ENDPOINT_FACTORIES.items()},
    "point_cloud_transport::create_publisher": _CLOUD_TRANSPORT.methods["advertise"],
    "point_cloud_transport::create_subscription": _CLOUD_TRANSPORT.methods["subscribe"],
}

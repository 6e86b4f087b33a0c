"""What the client libraries declare: the same calls in both languages end here."""

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.move_group import move_group_endpoints
from rtron.sources.code.library_models.ros1_common.names import remap_name, resolve_name
from rtron.sources.declaration import DeclarationKind
from rtron.vocabulary import Evidence

TRANSPORTS = {
    "compressed": "sensor_msgs/CompressedImage",
    "compressedDepth": "sensor_msgs/CompressedImage",
    "theora": "theora_image_transport/Packet",
}
"""The plugins of image_transport_plugins (ROS wiki: image_transport)."""

_PUBLISH = DeclarationKind.PUBLISH
_SUBSCRIBE = DeclarationKind.SUBSCRIBE
_RECONFIGURE_TOPICS = {
    "parameter_descriptions": "dynamic_reconfigure/ConfigDescription",
    "parameter_updates": "dynamic_reconfigure/Config",
}


def declare_endpoint(
    machine: AbstractMachine,
    kind: DeclarationKind,
    name: av.Value,
    type: str,
    at: Arguments | Evidence,
    *,
    implicit: bool = False,
    latched: bool = False,
) -> None:
    """Record an absolute name."""
    evidence = at.evidence if isinstance(at, Arguments) else at
    machine.recorder.declare(kind, name, type, evidence, implicit=implicit, latched=latched)


def name_below(namespace: av.Value, *names: str) -> av.Value:
    """Return a name below an absolute namespace."""
    return av.concat((namespace, av.Scalar("/" + "/".join(names))))


def declare_dynamic_reconfigure(
    machine: AbstractMachine, namespace: av.Value, at: Arguments, *, client: bool = False
) -> None:
    """Record what a dynamic_reconfigure server or client declares (ROS wiki)."""
    kind = _SUBSCRIBE if client else _PUBLISH
    for name, type in _RECONFIGURE_TOPICS.items():
        topic = name_below(namespace, name)
        declare_endpoint(machine, kind, topic, type, at, implicit=True, latched=not client)
    kind = DeclarationKind.SERVICE_CLIENT if client else DeclarationKind.SERVICE
    service, type = name_below(namespace, "set_parameters"), "dynamic_reconfigure/Reconfigure"
    declare_endpoint(machine, kind, service, type, at, implicit=True)


def declare_move_group_client(machine: AbstractMachine, namespace: av.Value, at: Arguments) -> None:
    """Record a client of the move_group in a namespace (MoveIt: move_group_interface)."""
    for kind, name, type, implicit in move_group_endpoints(1):
        full = resolve_name(machine, av.Scalar(name), namespace)
        declare_endpoint(machine, kind, full, type, at, implicit=implicit)


def declare_transforms(
    machine: AbstractMachine, kind: DeclarationKind, at: Arguments, *, static: bool
) -> None:
    """Record that a node publishes or subscribes to transforms (ROS wiki: tf2)."""
    sent = ("/tf_static",) if static else ("/tf",)
    for name in ("/tf", "/tf_static") if kind is _SUBSCRIBE else sent:
        declare_endpoint(machine, kind, av.Scalar(name), "tf2_msgs/TFMessage", at, implicit=True)


def declare_diagnostics(machine: AbstractMachine, at: Arguments) -> None:
    """Record a diagnostic_updater (ROS wiki: diagnostic_updater)."""
    type = "diagnostic_msgs/DiagnosticArray"
    declare_endpoint(machine, _PUBLISH, av.Scalar("/diagnostics"), type, at, implicit=True)


def declare_bond(machine: AbstractMachine, name: av.Value, at: Arguments) -> None:
    """Record a bond, which publishes and subscribes (ROS wiki: bond)."""
    for kind in (_PUBLISH, _SUBSCRIBE):
        declare_endpoint(machine, kind, name, "bond/Status", at, implicit=True)


def declare_image_publisher(machine: AbstractMachine, name: av.Value, at: Arguments) -> None:
    """Record what image_transport advertises: the image, and what its plugins add to it."""
    declare_endpoint(machine, _PUBLISH, name, "sensor_msgs/Image", at)
    base = remap_name(machine, name)
    for transport, type in TRANSPORTS.items():
        topic = name_below(base, transport)
        declare_endpoint(machine, _PUBLISH, topic, type, at, implicit=True)
        declare_dynamic_reconfigure(machine, topic, at)


def declare_image_subscriber(
    machine: AbstractMachine, name: av.Value, transport: av.Value | None, at: Arguments
) -> None:
    """Record what image_transport subscribes: the image itself, or one transport of it."""
    chosen = transport.value if isinstance(transport, av.Scalar) else "raw"
    if chosen in TRANSPORTS:
        topic = name_below(remap_name(machine, name), str(chosen))
        declare_endpoint(machine, _SUBSCRIBE, topic, TRANSPORTS[str(chosen)], at)
    else:
        declare_endpoint(machine, _SUBSCRIBE, name, "sensor_msgs/Image", at)


def camera_info_topic(machine: AbstractMachine, image: av.Value) -> av.Value:
    """Return where the camera info of an image topic is (image_transport: getCameraInfoTopic)."""
    name = remap_name(machine, image)
    if isinstance(name, av.Scalar):
        return av.Scalar(str(name.value).rpartition("/")[0] + "/camera_info", name.tainted)
    return name_below(name, "..", "camera_info")


def resolve_private(machine: AbstractMachine) -> av.Value:
    """Return the namespace of the node itself."""
    return resolve_name(machine, av.Scalar("~"))

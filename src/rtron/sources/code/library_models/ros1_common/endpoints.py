"""What the client libraries declare: the same calls in both languages end here."""

from rtron.sources.code.interpreter.abstract_values.value_types import Known, Value, concat
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros1_common.names import remapped, resolve
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


def declare(
    machine: Machine,
    kind: DeclarationKind,
    name: Value,
    type: str,
    at: Arguments | Evidence,
    *,
    implicit: bool = False,
    latched: bool = False,
) -> None:
    """Record an absolute name."""
    evidence = at.evidence if isinstance(at, Arguments) else at
    machine.recorder.declare(kind, name, type, evidence, implicit=implicit, latched=latched)


def below(namespace: Value, *names: str) -> Value:
    """Return a name below an absolute namespace."""
    return concat((namespace, Known("/" + "/".join(names))))


def dynamic_reconfigure(machine: Machine, namespace: Value, at: Arguments) -> None:
    """Record what a dynamic_reconfigure server declares (ROS wiki: dynamic_reconfigure)."""
    for name, type in (
        ("parameter_descriptions", "dynamic_reconfigure/ConfigDescription"),
        ("parameter_updates", "dynamic_reconfigure/Config"),
    ):
        declare(machine, _PUBLISH, below(namespace, name), type, at, implicit=True, latched=True)
    service = below(namespace, "set_parameters")
    type = "dynamic_reconfigure/Reconfigure"
    declare(machine, DeclarationKind.SERVICE, service, type, at, implicit=True)


def transforms(machine: Machine, kind: DeclarationKind, at: Arguments, *, static: bool) -> None:
    """Record that a node sends or hears transforms (ROS wiki: tf2)."""
    sent = ("/tf_static",) if static else ("/tf",)
    for name in ("/tf", "/tf_static") if kind is _SUBSCRIBE else sent:
        declare(machine, kind, Known(name), "tf2_msgs/TFMessage", at, implicit=True)


def diagnostics(machine: Machine, at: Arguments) -> None:
    """Record a diagnostic_updater (ROS wiki: diagnostic_updater)."""
    type = "diagnostic_msgs/DiagnosticArray"
    declare(machine, _PUBLISH, Known("/diagnostics"), type, at, implicit=True)


def bond(machine: Machine, name: Value, at: Arguments) -> None:
    """Record a bond, which both speaks and hears (ROS wiki: bond)."""
    for kind in (_PUBLISH, _SUBSCRIBE):
        declare(machine, kind, name, "bond/Status", at, implicit=True)


def image_publisher(machine: Machine, name: Value, at: Arguments) -> None:
    """Record what image_transport advertises: the image, and what its plugins add to it."""
    declare(machine, _PUBLISH, name, "sensor_msgs/Image", at)
    base = remapped(machine, name)
    for transport, type in TRANSPORTS.items():
        topic = below(base, transport)
        declare(machine, _PUBLISH, topic, type, at, implicit=True)
        dynamic_reconfigure(machine, topic, at)


def image_subscriber(machine: Machine, name: Value, transport: Value | None, at: Arguments) -> None:
    """Record what image_transport subscribes: the image itself, or one transport of it."""
    chosen = transport.value if isinstance(transport, Known) else "raw"
    if chosen in TRANSPORTS:
        topic = below(remapped(machine, name), str(chosen))
        declare(machine, _SUBSCRIBE, topic, TRANSPORTS[str(chosen)], at)
    else:
        declare(machine, _SUBSCRIBE, name, "sensor_msgs/Image", at)


def camera_info(machine: Machine, image: Value) -> Value:
    """Return where the camera info of an image topic is (image_transport: getCameraInfoTopic)."""
    name = remapped(machine, image)
    if isinstance(name, Known):
        return Known(str(name.value).rpartition("/")[0] + "/camera_info", name.tainted)
    return below(name, "..", "camera_info")


def own_namespace(machine: Machine, name: str = "~") -> Value:
    """Return a name resolved in the node itself."""
    return resolve(machine, Known(name))

"""What the client libraries declare: the same calls in both languages end here."""

from collections.abc import Mapping
from typing import NamedTuple

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

_PUBLISH, _SUBSCRIBE = DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE
_SERVICE, _TF = DeclarationKind.SERVICE, "tf2_msgs/TFMessage"


class LibraryEndpoint(NamedTuple):
    """An endpoint that a library makes; a name without `/` at its beginning is below another."""

    kind: DeclarationKind
    name: str
    type: str
    implicit: bool = True
    latched: bool = False


_RECONFIGURE = "dynamic_reconfigure"
_LIBRARIES: Mapping[str, tuple[LibraryEndpoint, ...]] = {
    "TransformListener": (
        LibraryEndpoint(_SUBSCRIBE, "/tf", _TF),
        LibraryEndpoint(_SUBSCRIBE, "/tf_static", _TF),
    ),
    "TransformBroadcaster": (LibraryEndpoint(_PUBLISH, "/tf", _TF),),
    "StaticTransformBroadcaster": (LibraryEndpoint(_PUBLISH, "/tf_static", _TF),),
    "diagnostic_updater": (
        LibraryEndpoint(_PUBLISH, "/diagnostics", "diagnostic_msgs/DiagnosticArray"),
    ),
    "bond": tuple(LibraryEndpoint(kind, "", "bond/Status") for kind in (_PUBLISH, _SUBSCRIBE)),
    "camera_info_manager": (
        LibraryEndpoint(_SERVICE, "set_camera_info", "sensor_msgs/SetCameraInfo"),
    ),
    "controller_manager": tuple(
        LibraryEndpoint(_SERVICE, name, f"controller_manager_msgs/{type}", implicit=False)
        for name, type in (
            ("list_controllers", "ListControllers"),
            ("list_controller_types", "ListControllerTypes"),
            ("load_controller", "LoadController"),
            ("unload_controller", "UnloadController"),
            ("switch_controller", "SwitchController"),
            ("reload_controller_libraries", "ReloadControllerLibraries"),
        )
    ),
    "interactive_markers": (
        LibraryEndpoint(_PUBLISH, "update", "visualization_msgs/InteractiveMarkerUpdate"),
        LibraryEndpoint(_PUBLISH, "update_full", "visualization_msgs/InteractiveMarkerInit"),
        LibraryEndpoint(_SUBSCRIBE, "feedback", "visualization_msgs/InteractiveMarkerFeedback"),
    ),
    "nodelet": (
        LibraryEndpoint(_SERVICE, "load_nodelet", "nodelet/NodeletLoad"),
        LibraryEndpoint(_SERVICE, "unload_nodelet", "nodelet/NodeletUnload"),
        LibraryEndpoint(_SERVICE, "list", "nodelet/NodeletList"),
    ),
    "planning_scene": tuple(
        LibraryEndpoint(_PUBLISH, name, f"moveit_msgs/{type}", implicit=False)
        for name, type in (
            ("collision_object", "CollisionObject"),
            ("attached_collision_object", "AttachedCollisionObject"),
        )
    ),
    **{
        f"{_RECONFIGURE}{side}": (
            LibraryEndpoint(
                topic,
                "parameter_descriptions",
                f"{_RECONFIGURE}/ConfigDescription",
                latched=not side,
            ),
            LibraryEndpoint(topic, "parameter_updates", f"{_RECONFIGURE}/Config", latched=not side),
            LibraryEndpoint(service, "set_parameters", f"{_RECONFIGURE}/Reconfigure"),
        )
        for side, topic, service in (
            ("", _PUBLISH, _SERVICE),
            (" client", _SUBSCRIBE, DeclarationKind.SERVICE_CLIENT),
        )
    },
    "move_group": tuple(LibraryEndpoint(*endpoint) for endpoint in move_group_endpoints(1)),
}
"""What an object of a library declares (ROS wiki: tf2, bond, nodelet, dynamic_reconfigure …)."""


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


def declare_library(
    machine: AbstractMachine, library: str, at: Arguments, base: av.Value | None = None
) -> None:
    """Record what an object of a library declares, below an absolute name."""
    for kind, name, type, implicit, latched in _LIBRARIES[library]:
        full = resolve_name(machine, av.Scalar(name), base) if name else base or av.UNKNOWN
        declare_endpoint(machine, kind, full, type, at, implicit=implicit, latched=latched)


def declare_image_publisher(machine: AbstractMachine, name: av.Value, at: Arguments) -> None:
    """Record what image_transport advertises: the image, and what its plugins add to it."""
    declare_endpoint(machine, _PUBLISH, name, "sensor_msgs/Image", at)
    base = remap_name(machine, name)
    for transport, type in TRANSPORTS.items():
        topic = name_below(base, transport)
        declare_endpoint(machine, _PUBLISH, topic, type, at, implicit=True)
        declare_library(machine, _RECONFIGURE, at, topic)


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

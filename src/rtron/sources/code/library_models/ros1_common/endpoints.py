"""What the client libraries declare: the same calls in both languages end here."""

from collections.abc import Mapping
from typing import NamedTuple

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.move_group import move_group_endpoints
from rtron.sources.code.library_models.ros1_common.names import resolve_name
from rtron.sources.declaration import DeclarationKind
from rtron.vocabulary import Evidence

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


def resolve_private(machine: AbstractMachine) -> av.Value:
    """Return the namespace of the node itself."""
    return resolve_name(machine, av.Scalar("~"))

"""Calls of what is not in the source that may join nodes: each is noted with its place."""

from collections.abc import Callable

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.assignment import note_plugin_id
from rtron.sources.code.interpreter.execution.calls import callee_name
from rtron.vocabulary import UnresolvedCause

_MAKERS = frozenset(
    [
        *("Publisher", "Subscriber", "Service", "ServiceProxy", "ActionServer", "ActionClient"),
        *("SimpleActionServer", "SimpleActionClient", "create_publisher", "create_subscription"),
        *("create_service", "create_client", "create_lifecycle_publisher"),
    ]
)
_MIN_ARGUMENTS = 2
_NOT_MADE = "is here, and a module of it that is called is not, which a build may make"
_INTERFACE_FOLDERS = {"msg", "srv", "action"}
_PACKAGES_WITHOUT_NODES = frozenset(
    [
        *("cv_bridge", "image_geometry", "angles", "tf2_geometry_msgs", "tf_conversions", "genpy"),
        *("ament_index_python", "rosidl_runtime_py", "rosbag", "roslib", "rospkg", "ros_numpy"),
        *("urdf_parser_py", "sensor_msgs_py", "tf2_py", "rosbag2_py", "launch", "launch_ros"),
        *("launch_testing", "rostest", "xacro", "catkin_pkg", "catkin", "rosunit"),
    ]
)
"""Packages of ROS whose Python modules only compute, or describe launches."""
_PYPI_MODULES = frozenset(
    [
        *("numpy", "scipy", "pandas", "matplotlib", "sklearn", "skimage", "cv2", "PIL", "yaml"),
        *("torch", "torchvision", "tensorflow", "keras", "ultralytics", "onnxruntime", "jax"),
        *("serial", "smbus", "smbus2", "usb", "RPi", "Jetson", "gpiozero", "pigpio", "spidev"),
        *("pygame", "pynput", "inputs", "evdev", "requests", "psutil", "zmq", "google", "grpc"),
    ]
)
"""Modules of PyPI that manifests name, too, as rosdep's keys or by mistake: no packages of ROS."""


def note_unknown_call(
    machine: AbstractMachine,
    called: av.Value,
    arguments: Arguments,
    is_known: Callable[[str], bool],
    is_foreign_package: Callable[[str], bool],
) -> None:
    """Note a call of what is not known, if it makes an endpoint by its name or by what it gets.

    One that gets the id of a plugin sends a goal, as those of nav2_simple_commander do.
    """
    name = callee_name(called)
    for keyword, value in arguments.keywords.items():
        note_plugin_id(machine, keyword, value, arguments.evidence)
    makes = name.rpartition(".")[2] in _MAKERS and len(arguments.all_values) >= _MIN_ARGUMENTS
    if makes and isinstance(called, (av.Unknown, av.ExternalSymbol)):
        first = next((v for v in arguments.all_values if av.is_text(v)), av.Unknown())
        what = f"{name}({av.text_with_holes(first)})"
        machine.recorder.add_unresolved(
            what, "what it is called on is not known", arguments.evidence
        )
    elif _is_foreign(called, is_known) and _gives_name_and_type(arguments):
        why = "its code is not here, and it gets a name and a type: it may make an endpoint"
        package = machine.runtime.missing_package(name)
        why += f"; give the source of {package} too" if package else ""
        machine.recorder.add_unresolved(
            f"{name}()", why, arguments.evidence, cause=UnresolvedCause.MISSING_CODE
        )
    top = name.partition(".")[0]
    if isinstance(called, av.ExternalSymbol) and is_foreign_package(top):
        is_here = machine.runtime.files.package_path(top) is not None
        why = _NOT_MADE if is_here else "is a ROS package that is not in the source"
        why += ": what it joins is not known"
        cause = None if is_here else UnresolvedCause.MISSING_SOURCE
        machine.recorder.add_unresolved(f"package {top}", why, arguments.evidence, cause=cause)


def _is_foreign(called: av.Value, is_known: Callable[[str], bool]) -> bool:
    return isinstance(called, av.ExternalSymbol) and not is_known(called.name)


def is_computing_package(name: str) -> bool:
    """Tell whether a package is known to join no nodes by itself."""
    return name in _PACKAGES_WITHOUT_NODES | _PYPI_MODULES or name.endswith(
        ("_msgs", "_srvs", "_interfaces")
    )


def _gives_name_and_type(arguments: Arguments) -> bool:
    given = arguments.all_values
    return any(map(av.is_text, given)) and any(map(_is_interface, given))


def _is_interface(value: av.Value) -> bool:
    if isinstance(value, av.ExternalSymbol):
        return not _INTERFACE_FOLDERS.isdisjoint(value.name.split(".")[1:-1])
    return isinstance(value, av.MessageType)

"""Hardware components of ros2_control: what a robot description gives them, and their node.

Source: ros2_control, hardware_interface (hardware_info.hpp, hardware_component_interface.hpp).
"""

from collections.abc import Mapping
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.trivial_functions import (
    returning_field,
    returning_unknown,
)
from rtron.sources.code.library_models.rclcpp.node import make_node
from rtron.sources.declaration import NodeSite

HARDWARE_CALLBACKS = ("on_init", "on_configure", "on_activate")
"""What the resource manager calls of a component, in this order, before it is read."""
_LATER_CALLBACKS = (
    *("read", "write", "export_state_interfaces", "export_command_interfaces"),
    *("perform_command_mode_switch", "on_deactivate", "on_cleanup", "on_shutdown", "on_error"),
)
_INFO, _NODE = "info_", "hardware.node"
_BASES = ("SystemInterface", "ActuatorInterface", "SensorInterface", "HardwareComponentInterface")


def hardware_info(site: NodeSite) -> av.Instance:
    """Return the HardwareInfo of a site's component, also as the parameters of a newer on_init."""
    hardware = site.hardware
    name = av.Scalar(hardware.name, tainted=True) if hardware else av.Unknown("hardware")
    given = hardware.parameters if hardware else ()
    parameters = av.MapValue({key: av.Scalar(text, tainted=True) for key, text in given})
    info = av.Instance(_INFO_CLASS, {"name": name, "hardware_parameters": parameters})
    return av.Instance(_INFO_CLASS, {**info.fields, "hardware_info": info})


def _make_hardware(name: str, machine: AbstractMachine, _: Arguments) -> av.Instance:
    return av.Instance(HARDWARE_CLASSES[name], {_INFO: hardware_info(machine.recorder.site)})


def _on_init(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`SystemInterface::on_init(info)` keeps what it is given."""
    given = arguments.get(0)
    if isinstance(given, av.Instance):
        machine.undo_log.set(owner.fields, _INFO, given.fields.get("hardware_info", given))
    return av.Unknown("CallbackReturn::SUCCESS")


def _get_node(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`get_node()`: since Kilted a component has a node, called like it."""
    if _NODE not in owner.fields:
        name = hardware_info(machine.recorder.site).fields["name"]
        plain = av.Scalar(_node_name(str(name.value))) if isinstance(name, av.Scalar) else name
        machine.undo_log.set(owner.fields, _NODE, make_node(machine, arguments.with_values(plain)))
    node: av.Value = owner.fields[_NODE]
    return node


def _node_name(hardware: str) -> str:
    return "".join(letter if letter.isalnum() else "_" for letter in hardware.lower())


_INFO_CLASS = av.LibraryClass("hardware_interface::HardwareInfo")
HARDWARE_CLASSES: Mapping[str, av.LibraryClass] = {
    name: av.LibraryClass(
        name,
        partial(_make_hardware, name),
        {
            "on_init": _on_init,
            "get_node": _get_node,
            "get_hardware_info": returning_field(_INFO, av.Unknown("info")),
            **dict.fromkeys(HARDWARE_CALLBACKS[1:], returning_unknown("CallbackReturn::SUCCESS")),
        },
        _LATER_CALLBACKS,
    )
    for name in (f"hardware_interface::{base}" for base in _BASES)
}

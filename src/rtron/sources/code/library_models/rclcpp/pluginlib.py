"""pluginlib in ROS 2: classes that are loaded by a name, most often a parameter's value.

Source: ros2_control, hardware_interface (hardware_info.hpp, hardware_component_interface.hpp).
"""

import re
from collections.abc import Mapping
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.language_runtime import cpp_runtime
from rtron.sources.code.library_models.common.navigation_plugins import (
    note_missing_plugin,
    throw_for_another_base,
)
from rtron.sources.code.library_models.common.trivial_functions import (
    return_argument,
    returning_unknown,
)
from rtron.sources.code.library_models.cpp_std.functional import hold_by_pointer
from rtron.sources.code.library_models.rclcpp.node import make_node
from rtron.sources.declaration import NodeSite

_CREATE = [f"create{kind}Instance" for kind in ("", "Shared", "Unique", "Unmanaged")]


def _make_loader(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """`pluginlib::ClassLoader<Base>(package, base)`."""
    return av.Instance(_LOADER, {"base": arguments.value(1), "truth": av.TRUE})


def _create_plugins(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """Make a plugin from its source; each that the workspace has where only the launch knows."""
    base = owner.fields.get("base", av.UNKNOWN)
    found: dict[str, av.Value] = {}
    if not _is_for_base(machine, arguments.value(0), base):
        throw_for_another_base(machine, arguments.value(0))
    for option in av.options(arguments.value(0)):
        names = _possible_plugins(machine, option, base, arguments)
        if not names and not machine.recorder.site.parameters_complete:
            continue
        for name in names or [option]:
            _load_plugin(machine, name, base, arguments, found)
    if not found and (machine.recorder.site.parameters_complete or not isinstance(base, av.Scalar)):
        note_missing_plugin(machine, arguments.value(0), arguments)
    return av.join(found.values()) if found else av.Unknown("plugin")


def _is_for_base(machine: AbstractMachine, name: av.Value, base: av.Value) -> bool:
    if not (isinstance(name, av.Scalar) and isinstance(base, av.Scalar)):
        return True
    return machine.runtime.files.find_plugin(str(name.value), str(base.value)) is not None


def _load_plugin(
    machine: AbstractMachine,
    name: av.Value,
    base: av.Value,
    arguments: Arguments,
    found: dict[str, av.Value],
) -> None:
    spelled_name = av.text_with_holes(name)
    if spelled_name in found or not (isinstance(name, av.Scalar) and isinstance(base, av.Scalar)):
        return
    made = cpp_runtime(machine).create_plugin(str(name.value), str(base.value), arguments)
    if made is not None:
        found[spelled_name] = hold_by_pointer(machine, made)
    else:
        note_missing_plugin(machine, name, arguments)


def _possible_plugins(
    machine: AbstractMachine, name: av.Value, base: av.Value, at: Arguments
) -> list[av.Value]:
    """Return the plugins that a name may mean: all of the base where no launch is known.

    These are taken once for each location: a plugin may load plugins of its own kind.
    """
    if isinstance(name, av.Scalar):
        return [name]
    if machine.recorder.site.parameters_complete or not isinstance(base, av.Scalar):
        return []
    location = (at.evidence.file, at.evidence.line, f"plugins of {base.value}")
    if location in machine.executed_functions:
        return []
    machine.executed_functions.add(location)
    form = re.compile(
        "".join(re.escape(p) if isinstance(p, str) else ".*" for p in av.parts_of(name))
    )
    names = filter(form.fullmatch, machine.runtime.files.plugin_names(str(base.value)))
    return [av.Scalar(one, tainted=True) for one in names]


def _is_available(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`isClassAvailable(name)`."""
    name, base = arguments.get(0), owner.fields.get("base", av.UNKNOWN)
    if not (isinstance(name, av.Scalar) and isinstance(base, av.Scalar)):
        return av.Unknown("isClassAvailable")
    found = machine.runtime.files.find_plugin(str(name.value), str(base.value))
    return av.FALSE if found is None and machine.recorder.site.parameters_complete else av.TRUE


_LOADER = av.LibraryClass(
    "pluginlib::ClassLoader",
    _make_loader,
    {
        **dict.fromkeys(_CREATE, _create_plugins),
        "isClassAvailable": _is_available,
        **dict.fromkeys(("getClassType", "getName"), return_argument),
    },
)
PLUGIN_CLASSES: Mapping[str, av.LibraryClass] = {_LOADER.name: _LOADER}


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
            **dict.fromkeys(HARDWARE_CALLBACKS[1:], returning_unknown("CallbackReturn::SUCCESS")),
        },
        _LATER_CALLBACKS,
    )
    for name in (f"hardware_interface::{base}" for base in _BASES)
}

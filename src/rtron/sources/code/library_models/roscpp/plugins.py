"""pluginlib and nodelet: classes loaded by name, nodelets, and their loader (ROS wiki)."""

import re

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.interpreter.execution.language_runtime import cpp_runtime
from rtron.sources.code.library_models.common.navigation_plugins import (
    note_missing_plugin,
    throw_for_another_base,
)
from rtron.sources.code.library_models.common.trivial_functions import returning_unknown
from rtron.sources.code.library_models.ros1_common import endpoints
from rtron.sources.code.library_models.ros1_common.names import node_namespace, resolve_name
from rtron.sources.code.library_models.roscpp import node_handle


def _make_loader(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """`pluginlib::ClassLoader<Base>(package, base)`."""
    return av.Instance(_LOADER, {"base": arguments.value(1)}, arguments.types)


def _create(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`loader.createInstance(name)`: the plugin's class, made from its source."""
    base = owner.fields.get("base", av.UNKNOWN)
    for option in av.options(arguments.get(0)):
        if isinstance(option, av.Scalar) and isinstance(base, av.Scalar):
            made = cpp_runtime(machine).create_plugin(str(option.value), str(base.value), arguments)
            if made is not None:
                return made
        if option is arguments.get(0) and isinstance(base, av.Scalar):
            throw_for_another_base(machine, option)
        note_missing_plugin(machine, option, arguments)
    return av.Unknown("plugin")


def _plugin_name(_: AbstractMachine, __: av.Instance, arguments: Arguments) -> av.Value:
    """`loader.getName("pkg::Class")` is its last part."""
    name = arguments.get(0)
    if not isinstance(name, av.Scalar):
        return av.Unknown("name")
    return av.Scalar(re.split("::|/", str(name.value))[-1])


_LOADER = av.LibraryClass(
    "pluginlib::ClassLoader",
    _make_loader,
    {
        **dict.fromkeys(
            (
                "createInstance",
                "createClassInstance",
                "createUnmanagedInstance",
                "createUniqueInstance",
            ),
            _create,
        ),
        "getName": _plugin_name,
        "isClassAvailable": returning_unknown("isClassAvailable"),
        "isClassLoaded": returning_unknown("isClassAvailable"),
    },
)

PLUGIN_CLASSES = {_LOADER.name: _LOADER}


_BASE = "nodelet::Nodelet"
_NAME = "nodelet name"
"""The field that holds the name of a nodelet that its own program has loaded."""


def start_nodelet(machine: AbstractMachine, nodelet: av.Value, at: Arguments) -> None:
    """Run what the loader runs of a nodelet that is made: its `onInit`."""
    method = cpp_runtime(machine).attribute(nodelet, "onInit", ())
    dispatch(machine, method or av.Unknown("onInit"), at.with_values())


def _name(machine: AbstractMachine, nodelet: av.Value) -> av.Value:
    """Return a nodelet's name: the node's, if a launch has started it as one.

    Handles that it makes itself, `ros::NodeHandle("~")`, are those of its manager.
    """
    loaded = nodelet.fields.get(_NAME) if isinstance(nodelet, av.Instance) else None
    return loaded or av.Scalar(machine.recorder.site.name)


def _handle(machine: AbstractMachine, nodelet: av.Value, _: Arguments) -> av.Value:
    name = _name(machine, nodelet)
    if not isinstance(name, av.Scalar):
        return node_handle.handle(av.Scalar(node_namespace(machine)))
    return node_handle.handle(av.Scalar(str(name.value).rpartition("/")[0] or "/"))


def _private_handle(machine: AbstractMachine, nodelet: av.Value, _: Arguments) -> av.Value:
    return node_handle.handle(_name(machine, nodelet))


def _make_nodelet_loader(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`Loader(bool provide_ros_api = true)`, `Loader(server_handle)`: it serves what loads more."""
    server = node_handle.handle_argument(arguments) or node_handle.private_handle(machine)
    if arguments.get(0) != av.FALSE:
        endpoints.declare_library(machine, "nodelet", arguments, server.fields["namespace"])
    return av.Instance(_NODELET_LOADER)


def _load(machine: AbstractMachine, _: av.Value, arguments: Arguments) -> av.Value:
    """`loader.load(name, type, remappings, argv)`: the nodelet runs in this process."""
    name, type, remaps = arguments.value(0), arguments.value(1), arguments.get(2)
    if isinstance(remaps, av.MapValue) and remaps.fields:
        node_handle.note_program_remaps(machine, arguments)
    made = None
    if isinstance(type, av.Scalar):
        made = cpp_runtime(machine).create_plugin(str(type.value), _BASE, arguments)
    if not isinstance(made, av.Instance):
        note_missing_plugin(machine, type, arguments)
        return av.Unknown("load")
    made.fields[_NAME] = resolve_name(machine, name)
    start_nodelet(machine, made, arguments)
    return av.Unknown("load")


_NODELET = av.LibraryClass(
    _BASE,
    methods={
        **dict.fromkeys(("getNodeHandle", "getMTNodeHandle"), _handle),
        **dict.fromkeys(("getPrivateNodeHandle", "getMTPrivateNodeHandle"), _private_handle),
        "getName": lambda machine, nodelet, ___: _name(machine, nodelet),
    },
)
_NODELET_LOADER = av.LibraryClass("nodelet::Loader", _make_nodelet_loader, {"load": _load})

NODELET_CLASSES = {
    _NODELET.name: _NODELET,
    _NODELET_LOADER.name: _NODELET_LOADER,
    "nodelet_topic_tools::NodeletLazy": _NODELET,
}

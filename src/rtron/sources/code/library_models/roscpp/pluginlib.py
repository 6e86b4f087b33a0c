"""pluginlib and nodelet: classes that are loaded by name (ROS wiki)."""

import re

from rtron.sources.code.interpreter.abstract_values.value_types import (
    UNKNOWN,
    Instance,
    LibraryClass,
    Scalar,
    Unknown,
    Value,
    options,
    text_with_holes,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.language_runtime import cpp_runtime
from rtron.sources.code.library_models.common.trivial_functions import returning_unknown
from rtron.sources.code.library_models.ros1_common.names import node_namespace
from rtron.sources.code.library_models.roscpp.node_handle import handle, private_handle


def _make_loader(_: AbstractMachine, arguments: Arguments) -> Value:
    """`pluginlib::ClassLoader<Base>(package, base)`."""
    return Instance(_LOADER, {"base": arguments.value(1)}, arguments.types)


def _create_instance(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`loader.createInstance(name)`: the plugin's class, made from its source."""
    base = owner.fields.get("base", UNKNOWN)
    for option in options(arguments.get(0)):
        if isinstance(option, Scalar) and isinstance(base, Scalar):
            made = cpp_runtime(machine).create_plugin(str(option.value), str(base.value), arguments)
            if made is not None:
                return made
        what = f"plugin {text_with_holes(option)}"
        machine.recorder.add_unresolved(what, "its source is not found", arguments.evidence)
    return Unknown("plugin")


def _plugin_name(_: AbstractMachine, __: Instance, arguments: Arguments) -> Value:
    """`loader.getName("pkg::Class")` is its last part."""
    name = arguments.get(0)
    if not isinstance(name, Scalar):
        return Unknown("name")
    return Scalar(re.split("::|/", str(name.value))[-1])


def _nodelet_handle(machine: AbstractMachine, _: Value, __: Arguments) -> Value:
    return handle(Scalar(node_namespace(machine)))


def _nodelet_private_handle(machine: AbstractMachine, _: Value, __: Arguments) -> Value:
    return private_handle(machine)


def _nodelet_name(machine: AbstractMachine, _: Value, __: Arguments) -> Value:
    return Scalar(machine.recorder.site.name)


def _nodelet_loader(_: AbstractMachine, __: Arguments) -> Value:
    return Instance(_NODELET_LOADER)


_LOADER = LibraryClass(
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
            _create_instance,
        ),
        "getName": _plugin_name,
        "isClassAvailable": returning_unknown("isClassAvailable"),
        "isClassLoaded": returning_unknown("isClassAvailable"),
    },
)
_NODELET = LibraryClass(
    "nodelet::Nodelet",
    methods={
        **dict.fromkeys(("getNodeHandle", "getMTNodeHandle"), _nodelet_handle),
        **dict.fromkeys(
            ("getPrivateNodeHandle", "getMTPrivateNodeHandle"), _nodelet_private_handle
        ),
        "getName": _nodelet_name,
    },
)
_NODELET_LOADER = LibraryClass("nodelet::Loader", _nodelet_loader)

PLUGIN_CLASSES = {
    **{cls.name: cls for cls in (_LOADER, _NODELET, _NODELET_LOADER)},
    "nodelet_topic_tools::NodeletLazy": _NODELET,
}

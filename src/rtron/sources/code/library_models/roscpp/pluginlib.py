"""pluginlib and nodelet: classes that are loaded by name (ROS wiki)."""

import re

from rtron.sources.code.interpreter.abstract_values.value_types import (
    Hole,
    Instance,
    Known,
    NativeClass,
    Value,
    options,
    spelled,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp import cpp
from rtron.sources.code.library_models.ros1_common.names import node_namespace
from rtron.sources.code.library_models.roscpp.node_handle import handle, private_handle

_UNKNOWN = Hole("?")


def _loader(_: Machine, arguments: Arguments) -> Value:
    """`pluginlib::ClassLoader<Base>(package, base)`."""
    return Instance(_LOADER, {"base": arguments.get(1) or _UNKNOWN}, arguments.types)


def _create_instance(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`loader.createInstance(name)`: the plugin's class, made from its source."""
    base = owner.fields.get("base", _UNKNOWN)
    for option in options(arguments.get(0)):
        if isinstance(option, Known) and isinstance(base, Known):
            made = cpp(machine).plugin(str(option.value), str(base.value), arguments)
            if made is not None:
                return made
        what = f"plugin {spelled(option)}"
        machine.recorder.unresolved(what, "its source is not found", arguments.evidence)
    return Hole("plugin")


def _plugin_name(_: Machine, __: Instance, arguments: Arguments) -> Value:
    """`loader.getName("pkg::Class")` is its last part."""
    name = arguments.get(0)
    if not isinstance(name, Known):
        return Hole("name")
    return Known(re.split("::|/", str(name.value))[-1])


def _available(_: Machine, __: Instance, ___: Arguments) -> Value:
    return Hole("isClassAvailable")


def _nodelet_handle(machine: Machine, _: Value, __: Arguments) -> Value:
    return handle(Known(node_namespace(machine)))


def _nodelet_private_handle(machine: Machine, _: Value, __: Arguments) -> Value:
    return private_handle(machine)


def _nodelet_name(machine: Machine, _: Value, __: Arguments) -> Value:
    return Known(machine.recorder.site.name)


def _nodelet_loader(_: Machine, __: Arguments) -> Value:
    return Instance(_NODELET_LOADER)


_LOADER = NativeClass(
    "pluginlib::ClassLoader",
    _loader,
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
        "isClassAvailable": _available,
        "isClassLoaded": _available,
    },
)
_NODELET = NativeClass(
    "nodelet::Nodelet",
    methods={
        **dict.fromkeys(("getNodeHandle", "getMTNodeHandle"), _nodelet_handle),
        **dict.fromkeys(
            ("getPrivateNodeHandle", "getMTPrivateNodeHandle"), _nodelet_private_handle
        ),
        "getName": _nodelet_name,
    },
)
_NODELET_LOADER = NativeClass("nodelet::Loader", _nodelet_loader)

PLUGIN_CLASSES = {
    **{native.name: native for native in (_LOADER, _NODELET, _NODELET_LOADER)},
    "nodelet_topic_tools::NodeletLazy": _NODELET,
}

"""pluginlib: classes that are loaded by name (ROS wiki)."""

import re

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.language_runtime import cpp_runtime
from rtron.sources.code.library_models.common.missing_plugins import (
    note_missing_plugin,
    throw_for_another_base,
)
from rtron.sources.code.library_models.common.trivial_functions import returning_unknown


def _make_loader(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """`pluginlib::ClassLoader<Base>(package, base)`."""
    return av.Instance(_LOADER, {"base": arguments.value(1)}, arguments.types)


def _create_instance(
    machine: AbstractMachine, owner: av.Instance, arguments: Arguments
) -> av.Value:
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
            _create_instance,
        ),
        "getName": _plugin_name,
        "isClassAvailable": returning_unknown("isClassAvailable"),
        "isClassLoaded": returning_unknown("isClassAvailable"),
    },
)

PLUGIN_CLASSES = {_LOADER.name: _LOADER}

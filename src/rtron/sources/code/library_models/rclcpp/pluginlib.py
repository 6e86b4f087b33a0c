"""pluginlib in ROS 2: classes that are loaded by a name, most often a parameter's value."""

import re
from collections.abc import Mapping

from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    TRUE,
    UNKNOWN,
    Instance,
    LibraryClass,
    Scalar,
    Unknown,
    Value,
    join,
    options,
    parts_of,
    text_with_holes,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.language_runtime import cpp_runtime
from rtron.sources.code.library_models.common.missing_plugins import (
    note_missing_plugin,
    throw_for_another_base,
)
from rtron.sources.code.library_models.common.trivial_functions import return_argument
from rtron.sources.code.library_models.cpp_std.functional import hold_by_pointer

_CREATE = (
    *("createInstance", "createSharedInstance", "createUniqueInstance"),
    "createUnmanagedInstance",
)


def _make_loader(_: AbstractMachine, arguments: Arguments) -> Value:
    """`pluginlib::ClassLoader<Base>(package, base)`."""
    return Instance(_LOADER, {"base": arguments.value(1), "truth": TRUE})


def _create_plugins(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """Make a plugin from its source; each that the workspace has where only the launch knows."""
    base = owner.fields.get("base", UNKNOWN)
    found: dict[str, Value] = {}
    if not _is_for_base(machine, arguments.value(0), base):
        throw_for_another_base(machine, arguments.value(0))
    for option in options(arguments.value(0)):
        names = _possible_plugins(machine, option, base, arguments)
        if not names and not machine.recorder.site.parameters_complete:
            continue
        for name in names or [option]:
            _load_plugin(machine, name, base, arguments, found)
    if not found and (machine.recorder.site.parameters_complete or not isinstance(base, Scalar)):
        note_missing_plugin(machine, arguments.value(0), arguments)
    return join(found.values()) if found else Unknown("plugin")


def _is_for_base(machine: AbstractMachine, name: Value, base: Value) -> bool:
    if not (isinstance(name, Scalar) and isinstance(base, Scalar)):
        return True
    return machine.runtime.files.find_plugin(str(name.value), str(base.value)) is not None


def _load_plugin(
    machine: AbstractMachine,
    name: Value,
    base: Value,
    arguments: Arguments,
    found: dict[str, Value],
) -> None:
    spelled_name = text_with_holes(name)
    if spelled_name in found or not (isinstance(name, Scalar) and isinstance(base, Scalar)):
        return
    made = cpp_runtime(machine).create_plugin(str(name.value), str(base.value), arguments)
    if made is not None:
        found[spelled_name] = hold_by_pointer(machine, made)
    else:
        note_missing_plugin(machine, name, arguments)


def _possible_plugins(
    machine: AbstractMachine, name: Value, base: Value, at: Arguments
) -> list[Value]:
    """Return the plugins that a name may mean: all of the base where no launch is known.

    These are taken once for each location: a plugin may load plugins of its own kind.
    """
    if isinstance(name, Scalar):
        return [name]
    if machine.recorder.site.parameters_complete or not isinstance(base, Scalar):
        return []
    location = (at.evidence.file, at.evidence.line, f"plugins of {base.value}")
    if location in machine.executed_functions:
        return []
    machine.executed_functions.add(location)
    form = re.compile("".join(re.escape(p) if isinstance(p, str) else ".*" for p in parts_of(name)))
    names = filter(form.fullmatch, machine.runtime.files.plugin_names(str(base.value)))
    return [Scalar(one, tainted=True) for one in names]


def _is_class_available(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`isClassAvailable(name)`."""
    name, base = arguments.get(0), owner.fields.get("base", UNKNOWN)
    if not (isinstance(name, Scalar) and isinstance(base, Scalar)):
        return Unknown("isClassAvailable")
    found = machine.runtime.files.find_plugin(str(name.value), str(base.value))
    return FALSE if found is None and machine.recorder.site.parameters_complete else TRUE


_LOADER = LibraryClass(
    "pluginlib::ClassLoader",
    _make_loader,
    {
        **dict.fromkeys(_CREATE, _create_plugins),
        "isClassAvailable": _is_class_available,
        **dict.fromkeys(("getClassType", "getName"), return_argument),
    },
)
PLUGIN_CLASSES: Mapping[str, LibraryClass] = {_LOADER.name: _LOADER}

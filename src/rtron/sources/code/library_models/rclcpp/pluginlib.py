"""pluginlib in ROS 2: classes that are loaded by a name, most often a parameter's value."""

import re
from collections.abc import Mapping

from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    TRUE,
    Hole,
    Instance,
    Known,
    NativeClass,
    Value,
    join,
    options,
    parts_of,
    spelled,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp import cpp
from rtron.sources.code.library_models.cpp_std.functional import shared

_UNKNOWN = Hole("?")
_CREATE = (
    *("createInstance", "createSharedInstance", "createUniqueInstance"),
    "createUnmanagedInstance",
)


def _loader(_: Machine, arguments: Arguments) -> Value:
    """`pluginlib::ClassLoader<Base>(package, base)`."""
    return Instance(_LOADER, {"base": arguments.get(1) or _UNKNOWN, "truth": TRUE})


def _create(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """Make a plugin from its source; each that the workspace has where only the launch knows."""
    base = owner.fields.get("base", _UNKNOWN)
    found: dict[str, Value] = {}
    for option in options(arguments.get(0) or _UNKNOWN):
        names = _meant(machine, option, base, arguments)
        if not names and not machine.recorder.site.complete:
            continue
        for name in names or [option]:
            _load(machine, name, base, arguments, found)
    if not found and (machine.recorder.site.complete or not isinstance(base, Known)):
        _missed(machine, arguments.get(0) or _UNKNOWN, arguments)
    return join(found.values()) if found else Hole("plugin")


def _load(
    machine: Machine, name: Value, base: Value, arguments: Arguments, found: dict[str, Value]
) -> None:
    spelled_name = spelled(name)
    if spelled_name in found or not (isinstance(name, Known) and isinstance(base, Known)):
        return
    made = cpp(machine).plugin(str(name.value), str(base.value), arguments)
    if made is not None:
        found[spelled_name] = shared(machine, made)
    else:
        _missed(machine, name, arguments)


def _missed(machine: Machine, name: Value, at: Arguments) -> None:
    """Note a plugin that is not here, or that only the running app names."""
    why = "its source is not found" if isinstance(name, Known) else "which one it is, is not known"
    machine.recorder.unresolved(f"plugin {spelled(name)}", why, at.evidence)


def _meant(machine: Machine, name: Value, base: Value, at: Arguments) -> list[Value]:
    """Return the plugins that a name may mean: all of the base where no launch is known.

    These are taken once for each place: a plugin may load plugins of its own kind.
    """
    if isinstance(name, Known):
        return [name]
    if machine.recorder.site.complete or not isinstance(base, Known):
        return []
    place = (at.evidence.file, at.evidence.line, f"plugins of {base.value}")
    if place in machine.ran:
        return []
    machine.ran.add(place)
    form = re.compile("".join(re.escape(p) if isinstance(p, str) else ".*" for p in parts_of(name)))
    names = filter(form.fullmatch, machine.world.files.plugins(str(base.value)))
    return [Known(one, tainted=True) for one in names]


def _available(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`isClassAvailable(name)`."""
    name, base = arguments.get(0), owner.fields.get("base", _UNKNOWN)
    if not (isinstance(name, Known) and isinstance(base, Known)):
        return Hole("isClassAvailable")
    found = machine.world.files.plugin(str(name.value), str(base.value))
    return FALSE if found is None and machine.recorder.site.complete else TRUE


def _type(_: Machine, __: Instance, arguments: Arguments) -> Value:
    """`getClassType(name)`: what a plugin is called, taken for its type."""
    return arguments.get(0) or _UNKNOWN


_LOADER = NativeClass(
    "pluginlib::ClassLoader",
    _loader,
    {
        **dict.fromkeys(_CREATE, _create),
        "isClassAvailable": _available,
        **dict.fromkeys(("getClassType", "getName"), _type),
    },
)
PLUGIN_CLASSES: Mapping[str, NativeClass] = {_LOADER.name: _LOADER}

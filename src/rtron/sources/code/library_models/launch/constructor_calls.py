"""The classes of ROS 2's launch: a call is kept as it stands, with its file and line.

What the calls mean is for the evaluator of launch descriptions; here they are only taken down.
Sources: the signatures of launch, launch_ros and nav2_common.
"""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Protocol

from rtron.sources.code.interpreter.abstract_values.items import items_of, listed
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    TRUE,
    Hole,
    Instance,
    Known,
    ListValue,
    MapValue,
    Native,
    NativeClass,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.containers import LIST
from rtron.sources.code.library_models.launch.paths import LAUNCH_PATHS, package_share
from rtron.sources.code.library_models.launch.signatures import CLASSES, MODULES

CALL, FILE, LINE, ALL = "#call", "#file", "#line", "#all"
_OWN = frozenset({CALL, FILE, LINE, ALL, "truth"})
ENTITIES, CONTEXT = "entities", "#context"


class Performs(Protocol):
    """A launch that is being evaluated, as its functions see it."""

    def perform(self, value: Value) -> Value:
        """Return the text that substitutions make."""
        ...


def call_name(value: Value) -> str:
    """Return the class of launch that an object is of; empty for any other value."""
    named = value.fields.get(CALL) if isinstance(value, Instance) else None
    return str(named.value) if isinstance(named, Known) else ""


def given(value: Instance) -> dict[str, Value]:
    """Return what an object of launch was made with, by the names of parameters."""
    return {str(key): inner for key, inner in value.fields.items() if key not in _OWN}


def _made(name: str, machine: Machine, _: object, arguments: Arguments) -> Value:
    del machine
    found: dict[str, Value] = {
        key: value
        for at, key in enumerate(CLASSES[name])
        if (value := arguments.get(at, key)) is not None
    }
    fields = {
        **arguments.keywords,
        **found,
        CALL: Known(name),
        FILE: Known(arguments.frame.file),
        LINE: Known(arguments.line),
        ALL: listed(arguments.values),
        "truth": TRUE,
    }
    if name == "LaunchDescription":
        items, certain = items_of(found.get("initial_entities", NONE))
        fields[ENTITIES] = ListValue({"items": items, "open": not certain})
    return Instance(_TYPES[name], fields)


def _add(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`description.add_action(action)`."""
    action = arguments.get(0, "action") or arguments.get(0, "entity") or NONE
    added = Arguments(values=(action,), frame=arguments.frame)
    return LIST["append"](machine, owner.fields[ENTITIES], added)


def _path(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`path / part`, as substitutions that make paths have it."""
    parts = listed((owner, arguments.get(0) or NONE))
    joined = Arguments(values=(parts,), line=arguments.line, frame=arguments.frame)
    return _made("PathJoinSubstitution", machine, None, joined)


def _perform(_: Machine, owner: Value, arguments: Arguments) -> Value:
    """`substitution.perform(context)`, and `condition.evaluate(context)`."""
    return _performed(arguments.get(0, "context"), owner)


def _performed(context: Value | None, text: Value) -> Value:
    known = context.fields.get(CONTEXT) if isinstance(context, Instance) else None
    launch: Performs | None = known.value if isinstance(known, Known) else None
    return launch.perform(text) if launch is not None else Hole("perform()")


def _perform_given(_: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`context.perform_substitution(substitution)`."""
    return _performed(owner, arguments.get(0, "substitution") or NONE)


def _perform_all(_: Machine, __: object, arguments: Arguments) -> Value:
    """`perform_substitutions(context, substitutions)`."""
    return _performed(arguments.get(0, "context"), arguments.get(1, "subs") or NONE)


def _same(_: Machine, __: object, arguments: Arguments) -> Value:
    return arguments.get(0) or NONE


_METHODS: dict[str, Callable[..., Value]] = {
    "add_action": _add,
    "add_entity": _add,
    "perform": _perform,
    "evaluate": _perform,
    "find": package_share,
}
_PATHS = {
    "PathJoinSubstitution",
    "PathSubstitution",
    "FindPackage",
    "FindPackagePrefix",
    "FindPackageShare",
    "LaunchLogDir",
    "ThisLaunchFileDir",
}
"""The substitutions that make paths: they have the operator `/` in all distributions by now."""
_TYPES: Mapping[str, NativeClass] = {
    name: NativeClass(
        f"launch.{name}", methods=_METHODS | ({"operator/": _path} if name in _PATHS else {})
    )
    for name in CLASSES
}
LAUNCH_CONTEXT = NativeClass(
    "launch.LaunchContext", methods={"perform_substitution": _perform_given}
)


def launch_context(launch: Performs, configurations: MapValue, environ: Value) -> Instance:
    """Return what a function of a launch file gets as its context."""
    fields: dict[str, Value] = {
        CONTEXT: Known(launch),
        "launch_configurations": configurations,
        "environment": environ,
        "argv": listed(()),
    }
    return Instance(LAUNCH_CONTEXT, fields)


LAUNCH_CALLS: Mapping[str, Value] = {
    **LAUNCH_PATHS,
    **{
        f"{module}.{name}": Native(name, partial(_made, name))
        for module, names in MODULES.items()
        for name in names
    },
    "launch.utilities.perform_substitutions": Native("perform_substitutions", _perform_all),
    "launch.utilities.normalize_to_list_of_substitutions": Native("normalize", _same),
}

"""The classes of ROS 2's launch: a call is kept as it stands, with its file and line.

What the calls mean is for the evaluator of launch descriptions; here they are only taken down.
Sources: the signatures of launch, launch_ros and nav2_common.
"""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Protocol

from rtron.sources.code.interpreter.abstract_values.items import items_of, list_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    TRUE,
    Instance,
    LibraryClass,
    LibraryFunction,
    MapValue,
    Scalar,
    Unknown,
    Value,
    map_options,
    text_with_holes,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.containers import LIST_METHODS
from rtron.sources.code.library_models.common.trivial_functions import return_argument
from rtron.sources.code.library_models.launch.signatures import (
    CLASSES_BY_MODULE,
    POSITIONAL_PARAMETERS,
)
from rtron.sources.code.library_models.python_std.package_paths import as_path
from rtron.sources.launch.ros2.substitutions.template import placeholder


def share_folder(machine: AbstractMachine, name: Value) -> Value:
    """Return the share folder of a package: in a workspace that is the package itself."""

    def found(one: Value) -> Value:
        if not isinstance(one, Scalar):
            return Unknown(f"find-pkg-share {text_with_holes(one)}")
        path = machine.runtime.files.package_path(str(one.value))
        return Scalar(placeholder(f"find-pkg-share {one.value}") if path is None else str(path))

    return map_options(name, found)


def find_package_share(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`get_package_share_directory(name)`, `FindPackageShare("").find(name)`."""
    return share_folder(machine, arguments.get(0, "package_name") or NONE)


def _share_path(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    return as_path(find_package_share(machine, None, arguments))


def _package_prefix(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`get_package_prefix(name)`: where it is installed is not known before a build."""

    def found(one: Value) -> Value:
        return Scalar(placeholder(f"find-pkg-prefix {text_with_holes(one)}"))

    return map_options(arguments.get(0, "package_name") or NONE, found)


_CALLS = {
    "get_package_share_directory": find_package_share,
    "get_package_share_path": _share_path,
    "get_package_prefix": _package_prefix,
}
AMENT_FUNCTIONS: Mapping[str, Value] = {
    f"{module}.{name}": LibraryFunction(name, partial(call))
    for module in ("ament_index_python", "ament_index_python.packages")
    for name, call in _CALLS.items()
}

CALL_FIELD, FILE_FIELD, LINE_FIELD, ARGUMENTS_FIELD = "#call", "#file", "#line", "#all"
_INTERNAL_FIELDS = frozenset({CALL_FIELD, FILE_FIELD, LINE_FIELD, ARGUMENTS_FIELD, "truth"})
ENTITIES_FIELD, CONTEXT_FIELD = "entities", "#context"


class SubstitutionPerformer(Protocol):
    """A launch that is being evaluated, as its functions see it."""

    def perform(self, value: Value) -> Value:
        """Return the text that substitutions make."""


def launch_class_name(value: Value) -> str:
    """Return the class of launch that an object is of; empty for any other value."""
    named = value.fields.get(CALL_FIELD) if isinstance(value, Instance) else None
    return str(named.value) if isinstance(named, Scalar) else ""


def constructor_arguments(value: Instance) -> dict[str, Value]:
    """Return what an object of launch was made with, by the names of parameters."""
    return {str(key): inner for key, inner in value.fields.items() if key not in _INTERNAL_FIELDS}


def _construct(name: str, machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    del machine
    found: dict[str, Value] = {
        key: value
        for at, key in enumerate(POSITIONAL_PARAMETERS[name])
        if (value := arguments.get(at, key)) is not None
    }
    fields = {
        **arguments.keywords,
        **found,
        CALL_FIELD: Scalar(name),
        FILE_FIELD: Scalar(arguments.frame.file),
        LINE_FIELD: Scalar(arguments.line),
        ARGUMENTS_FIELD: list_of(arguments.values),
        "truth": TRUE,
    }
    if name == "LaunchDescription":
        items, certain = items_of(found.get("initial_entities", NONE))
        fields[ENTITIES_FIELD] = list_of(items, certain=certain)
    return Instance(_TYPES[name], fields)


def _add_entity(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`description.add_action(action)`."""
    action = arguments.get(0, "action") or arguments.get(0, "entity") or NONE
    added = arguments.with_values(action)
    return LIST_METHODS["append"](machine, owner.fields[ENTITIES_FIELD], added)


def _launch_arguments(_: AbstractMachine, owner: Instance, __: Arguments) -> Value:
    """`description.get_launch_arguments()`; what it includes may declare more."""
    entities, certain = items_of(owner.fields.get(ENTITIES_FIELD, NONE))
    declared = [
        Instance(each.type, {**_OPTIONAL_OF_ARGUMENTS, **each.fields})
        for each in entities
        if isinstance(each, Instance) and launch_class_name(each) == "DeclareLaunchArgument"
    ]
    return list_of(declared, certain=certain and len(declared) == len(entities))


_OPTIONAL_OF_ARGUMENTS: Mapping[str, Value] = dict.fromkeys(
    ("default_value", "description", "choices"), NONE
)


def _join_path(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`path / part`, as substitutions that make paths have it."""
    parts = list_of((owner, arguments.get(0) or NONE))
    joined = arguments.with_values(parts)
    return _construct("PathJoinSubstitution", machine, None, joined)


def _perform_self(_: AbstractMachine, owner: Value, arguments: Arguments) -> Value:
    """`substitution.perform(context)`, and `condition.evaluate(context)`."""
    return _perform_in_context(arguments.get(0, "context"), owner)


def _perform_in_context(context: Value | None, text: Value) -> Value:
    known = context.fields.get(CONTEXT_FIELD) if isinstance(context, Instance) else None
    launch: SubstitutionPerformer | None = known.value if isinstance(known, Scalar) else None
    return launch.perform(text) if launch is not None else Unknown("perform()")


def _perform_argument(_: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`context.perform_substitution(substitution)`."""
    return _perform_in_context(owner, arguments.get(0, "substitution") or NONE)


def _perform_substitutions(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`perform_substitutions(context, substitutions)`."""
    return _perform_in_context(arguments.get(0, "context"), arguments.get(1, "subs") or NONE)


_METHODS: dict[str, Callable[..., Value]] = {
    "add_action": _add_entity,
    "add_entity": _add_entity,
    "get_launch_arguments": _launch_arguments,
    "perform": _perform_self,
    "evaluate": _perform_self,
    "find": find_package_share,
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
_TYPES: Mapping[str, LibraryClass] = {
    name: LibraryClass(
        f"launch.{name}", methods=_METHODS | ({"operator/": _join_path} if name in _PATHS else {})
    )
    for name in POSITIONAL_PARAMETERS
}
LAUNCH_CONTEXT = LibraryClass(
    "launch.LaunchContext", methods={"perform_substitution": _perform_argument}
)


def launch_context(
    launch: SubstitutionPerformer, configurations: MapValue, environ: Value
) -> Instance:
    """Return what a function of a launch file gets as its context."""
    fields: dict[str, Value] = {
        CONTEXT_FIELD: Scalar(launch),
        "launch_configurations": configurations,
        "environment": environ,
        "argv": list_of(()),
    }
    return Instance(LAUNCH_CONTEXT, fields)


LAUNCH_FUNCTIONS: Mapping[str, Value] = {
    **AMENT_FUNCTIONS,
    **{
        f"{module}.{name}": LibraryFunction(name, partial(_construct, name))
        for module, names in CLASSES_BY_MODULE.items()
        for name in names
    },
    "launch.utilities.perform_substitutions": LibraryFunction(
        "perform_substitutions", _perform_substitutions
    ),
    "launch.utilities.normalize_to_list_of_substitutions": LibraryFunction(
        "normalize", return_argument
    ),
}

"""The classes of ROS 2's launch: a call is kept as it stands, with its file and line.

What the calls mean is for the evaluator of launch descriptions; here they are only taken down.
Sources: the signatures of launch, launch_ros and nav2_common.
"""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Protocol

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.containers import LIST_METHODS
from rtron.sources.code.library_models.common.trivial_functions import return_argument
from rtron.sources.code.library_models.launch.signatures import (
    CLASSES_BY_MODULE,
    POSITIONAL_PARAMETERS,
)
from rtron.sources.code.library_models.python_std.paths import as_path
from rtron.sources.launch.ros2.substitutions.template import placeholder


def share_folder(machine: AbstractMachine, name: av.Value) -> av.Value:
    """Return the share folder of a package: in a workspace that is the package itself."""

    def found(one: av.Value) -> av.Value:
        if not isinstance(one, av.Scalar):
            return av.Unknown(f"find-pkg-share {av.text_with_holes(one)}")
        path = machine.runtime.files.package_path(str(one.value))
        return av.Scalar(placeholder(f"find-pkg-share {one.value}") if path is None else str(path))

    return av.map_options(name, found)


def find_package_share(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`get_package_share_directory(name)`, `FindPackageShare("").find(name)`."""
    return share_folder(machine, arguments.get(0, "package_name") or av.NONE)


def _package_prefix(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`get_package_prefix(name)`: where it is installed is not known before a build."""

    def found(one: av.Value) -> av.Value:
        return av.Scalar(placeholder(f"find-pkg-prefix {av.text_with_holes(one)}"))

    return av.map_options(arguments.get(0, "package_name") or av.NONE, found)


_CALLS = {
    "get_package_share_directory": find_package_share,
    "get_package_share_path": lambda machine, __, arguments: as_path(
        find_package_share(machine, None, arguments)
    ),
    "get_package_prefix": _package_prefix,
}
AMENT_FUNCTIONS: Mapping[str, av.Value] = {
    f"{module}.{name}": av.LibraryFunction(name, partial(call))
    for module in ("ament_index_python", "ament_index_python.packages")
    for name, call in _CALLS.items()
}

CALL_FIELD, FILE_FIELD, LINE_FIELD, ARGUMENTS_FIELD = "#call", "#file", "#line", "#all"
_INTERNAL_FIELDS = frozenset({CALL_FIELD, FILE_FIELD, LINE_FIELD, ARGUMENTS_FIELD, "truth"})
ENTITIES_FIELD, CONTEXT_FIELD = "entities", "#context"


class SubstitutionPerformer(Protocol):
    """A launch that is being evaluated, as its functions see it."""

    def perform(self, value: av.Value) -> av.Value:
        """Return the text that substitutions make."""


def launch_class_name(value: av.Value) -> str:
    """Return the class of launch that an object is of; empty for any other value."""
    named = value.fields.get(CALL_FIELD) if isinstance(value, av.Instance) else None
    return str(named.value) if isinstance(named, av.Scalar) else ""


def constructor_arguments(value: av.Instance) -> dict[str, av.Value]:
    """Return what an object of launch was made with, by the names of parameters."""
    return {str(key): inner for key, inner in value.fields.items() if key not in _INTERNAL_FIELDS}


def _construct(name: str, machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    del machine
    found: dict[str, av.Value] = {
        key: value
        for at, key in enumerate(POSITIONAL_PARAMETERS[name])
        if (value := arguments.get(at, key)) is not None
    }
    fields = {
        **arguments.keywords,
        **found,
        CALL_FIELD: av.Scalar(name),
        FILE_FIELD: av.Scalar(arguments.frame.file),
        LINE_FIELD: av.Scalar(arguments.line),
        ARGUMENTS_FIELD: av.list_of(arguments.values),
        "truth": av.TRUE,
    }
    if name == "LaunchDescription":
        items, certain = av.items_of(found.get("initial_entities", av.NONE))
        fields[ENTITIES_FIELD] = av.list_of(items, certain=certain)
    return av.Instance(_TYPES[name], fields)


def _add_entity(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`description.add_action(action)`."""
    action = arguments.get(0, "action") or arguments.get(0, "entity") or av.NONE
    added = arguments.with_values(action)
    return LIST_METHODS["append"](machine, owner.fields[ENTITIES_FIELD], added)


def _launch_arguments(_: AbstractMachine, owner: av.Instance, __: Arguments) -> av.Value:
    """`description.get_launch_arguments()`; what it includes may declare more."""
    entities, certain = av.items_of(owner.fields.get(ENTITIES_FIELD, av.NONE))
    declared = [
        av.Instance(each.type, {**_OPTIONAL_OF_ARGUMENTS, **each.fields})
        for each in entities
        if isinstance(each, av.Instance) and launch_class_name(each) == "DeclareLaunchArgument"
    ]
    return av.list_of(declared, certain=certain and len(declared) == len(entities))


_OPTIONAL_OF_ARGUMENTS: Mapping[str, av.Value] = dict.fromkeys(
    ("default_value", "description", "choices"), av.NONE
)


def _join_path(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`path / part`, as substitutions that make paths have it."""
    parts = av.list_of((owner, arguments.get(0) or av.NONE))
    joined = arguments.with_values(parts)
    return _construct("PathJoinSubstitution", machine, None, joined)


def _perform_self(_: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`substitution.perform(context)`, and `condition.evaluate(context)`."""
    return _perform_in_context(arguments.get(0, "context"), owner)


def _perform_in_context(context: av.Value | None, text: av.Value) -> av.Value:
    known = context.fields.get(CONTEXT_FIELD) if isinstance(context, av.Instance) else None
    launch: SubstitutionPerformer | None = known.value if isinstance(known, av.Scalar) else None
    return launch.perform(text) if launch is not None else av.Unknown("perform()")


def _perform_argument(_: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`context.perform_substitution(substitution)`."""
    return _perform_in_context(owner, arguments.get(0, "substitution") or av.NONE)


def _perform_substitutions(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`perform_substitutions(context, substitutions)`."""
    return _perform_in_context(arguments.get(0, "context"), arguments.get(1, "subs") or av.NONE)


_METHODS: dict[str, Callable[..., av.Value]] = {
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
_TYPES: Mapping[str, av.LibraryClass] = {
    name: av.LibraryClass(
        f"launch.{name}", methods=_METHODS | ({"operator/": _join_path} if name in _PATHS else {})
    )
    for name in POSITIONAL_PARAMETERS
}
LAUNCH_CONTEXT = av.LibraryClass(
    "launch.LaunchContext", methods={"perform_substitution": _perform_argument}
)


def launch_context(
    launch: SubstitutionPerformer, configurations: av.MapValue, environ: av.Value
) -> av.Instance:
    """Return what a function of a launch file gets as its context."""
    fields: dict[str, av.Value] = {
        CONTEXT_FIELD: av.Scalar(launch),
        "launch_configurations": configurations,
        "environment": environ,
        "argv": av.list_of(()),
    }
    return av.Instance(LAUNCH_CONTEXT, fields)


LAUNCH_FUNCTIONS: Mapping[str, av.Value] = {
    **AMENT_FUNCTIONS,
    **{
        f"{module}.{name}": av.LibraryFunction(name, partial(_construct, name))
        for module, names in CLASSES_BY_MODULE.items()
        for name in names
    },
    "launch.utilities.perform_substitutions": av.LibraryFunction(
        "perform_substitutions", _perform_substitutions
    ),
    "launch.utilities.normalize_to_list_of_substitutions": av.LibraryFunction(
        "normalize", return_argument
    ),
}

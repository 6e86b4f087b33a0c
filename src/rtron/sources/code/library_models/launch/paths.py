"""Where packages lie, as a launch file in Python asks ament; that of one not here has a hole."""

from collections.abc import Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    LibraryFunction,
    Scalar,
    Unknown,
    Value,
    map_options,
    text_with_holes,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.python_std.paths import PathString
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
    found = find_package_share(machine, None, arguments)
    return Scalar(PathString(found.value)) if isinstance(found, Scalar) else found


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

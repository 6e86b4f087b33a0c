"""Where packages lie: rospkg, roslib, ament_index_python, resource_retriever.

In a workspace a package's share folder is the package itself.
"""

from collections.abc import Callable, Mapping

from rtron.sources.code.interpreter.abstract_values.items import list_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    NONE,
    Instance,
    LibraryClass,
    PartialText,
    Scalar,
    Unknown,
    Value,
    map_options,
    text_with_holes,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.python_std.paths import PathString

_PATH_OF = "path of "


def _folder(machine: AbstractMachine, name: Value) -> Value:
    path = machine.runtime.files.package_path(str(name.value)) if isinstance(name, Scalar) else None
    return Unknown(f"{_PATH_OF}{text_with_holes(name)}") if path is None else Scalar(str(path))


def missing_package(path: Value) -> str:
    """Return the package that is not here and that a path begins with; empty for another path."""
    first = path.parts[0] if isinstance(path, PartialText) else path
    return first.label.partition(_PATH_OF)[2] if isinstance(first, Unknown) else ""


def _package_folder(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`RosPack().get_path(name)`, `get_package_share_directory(name)`."""
    name = arguments.get(0) or arguments.get(0, "package_name") or NONE
    return map_options(name, lambda one: _folder(machine, one))


def _package_path(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`get_package_share_path(name)`: a `pathlib.Path`."""
    return as_path(_package_folder(machine, None, arguments))


def as_path(text: Value) -> Value:
    """Return the path that a text says, where it is known."""
    return map_options(
        text, lambda one: Scalar(PathString(one.value)) if isinstance(one, Scalar) else one
    )


def _search_paths(machine: AbstractMachine, _: object, __: Arguments) -> Value:
    """`get_search_paths()`: colcon installs each package of a workspace below its own name."""
    names = machine.runtime.files.package_names()
    return list_of([Scalar(f"/install/{name}") for name in names])


def _resource_file(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`resource_retriever.get_filename("package://p/file", use_protocol=False)`."""
    protocol = "" if arguments.get(1, "use_protocol") == FALSE else "file://"

    def found(one: Value) -> Value:
        text = str(one.value) if isinstance(one, Scalar) else ""
        package, _, rest = text.removeprefix("package://").partition("/")
        folder = _folder(machine, Scalar(package))
        if not text.startswith("package://") or not isinstance(folder, Scalar):
            return Unknown(f"path of {text_with_holes(one)}")
        return Scalar(f"{protocol}{folder.value}/{rest}")

    return map_options(arguments.get(0, "url") or NONE, found)


_ROSPACK = LibraryClass("rospkg.RosPack", methods={"get_path": _package_folder})


def _rospack(_: AbstractMachine, __: object, ___: Arguments) -> Value:
    return Instance(_ROSPACK)


PACKAGE_PATHS: Mapping[str, Callable[..., Value]] = {
    "rospkg.RosPack": _rospack,
    "rospkg.rospack.RosPack": _rospack,
    "roslib.packages.get_pkg_dir": _package_folder,
    "roslib.packages.get_dir_pkg": _package_folder,
    "resource_retriever.get_filename": _resource_file,
    **{
        f"{module}.{name}": call
        for module in ("ament_index_python", "ament_index_python.packages")
        for name, call in (
            ("get_package_share_directory", _package_folder),
            ("get_package_share_path", _package_path),
            ("get_search_paths", _search_paths),
        )
    },
}

"""Where packages lie: rospkg, roslib, ament_index_python, resource_retriever.

In a workspace a package's share folder is the package itself.
"""

from collections.abc import Callable, Mapping

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.trivial_functions import making
from rtron.sources.code.library_models.python_std.paths import PathString

_PATH_OF = "path of "


def _folder(machine: AbstractMachine, name: av.Value) -> av.Value:
    path = (
        machine.runtime.files.package_path(str(name.value)) if isinstance(name, av.Scalar) else None
    )
    return (
        av.Unknown(f"{_PATH_OF}{av.text_with_holes(name)}")
        if path is None
        else av.Scalar(str(path))
    )


def missing_package(path: av.Value) -> str:
    """Return the package that is not here and that a path begins with; empty for another path."""
    first = path.parts[0] if isinstance(path, av.PartialText) else path
    return first.label.partition(_PATH_OF)[2] if isinstance(first, av.Unknown) else ""


def _package_folder(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`RosPack().get_path(name)`, `get_package_share_directory(name)`."""
    name = arguments.get(0) or arguments.get(0, "package_name") or av.NONE
    return av.map_options(name, lambda one: _folder(machine, one))


def _package_path(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`get_package_share_path(name)`: a `pathlib.Path`."""
    return as_path(_package_folder(machine, None, arguments))


def as_path(text: av.Value) -> av.Value:
    """Return the path that a text says, where it is known."""
    return av.map_options(
        text, lambda one: av.Scalar(PathString(one.value)) if isinstance(one, av.Scalar) else one
    )


def _search_paths(machine: AbstractMachine, _: object, __: Arguments) -> av.Value:
    """`get_search_paths()`: colcon installs each package of a workspace below its own name."""
    names = machine.runtime.files.package_names()
    return av.list_of([av.Scalar(f"/install/{name}") for name in names])


def _resource_file(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`resource_retriever.get_filename("package://p/file", use_protocol=False)`."""
    protocol = "" if arguments.get(1, "use_protocol") == av.FALSE else "file://"

    def found(one: av.Value) -> av.Value:
        text = str(one.value) if isinstance(one, av.Scalar) else ""
        package, _, rest = text.removeprefix("package://").partition("/")
        folder = _folder(machine, av.Scalar(package))
        if not text.startswith("package://") or not isinstance(folder, av.Scalar):
            return av.Unknown(f"path of {av.text_with_holes(one)}")
        return av.Scalar(f"{protocol}{folder.value}/{rest}")

    return av.map_options(arguments.get(0, "url") or av.NONE, found)


_ROSPACK = av.LibraryClass("rospkg.RosPack", methods={"get_path": _package_folder})


PACKAGE_PATHS: Mapping[str, Callable[..., av.Value]] = {
    "rospkg.RosPack": making(_ROSPACK),
    "rospkg.rospack.RosPack": making(_ROSPACK),
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

"""Python's pathlib: a path is a text that knows its parts. Only what is there is looked at.

In a workspace a package's share folder is the package itself.
"""

import json
import os.path
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path, PurePosixPath

from rtron.errors import InputError
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.trivial_functions import making
from rtron.sources.code.library_models.python_std.builtin_functions import FILE
from rtron.sources.code.library_models.ros1_common.names import abstract_value
from rtron.sources.launch.common.yaml_tree import parse_yaml, plain_value


class PathString(str):
    """A path object's text."""

    __slots__ = ()

    def __truediv__(self, other: str) -> "PathString":
        return PathString(os.path.join(str(self), str(other)))  # noqa: PTH118 - no path is looked at

    def __rtruediv__(self, other: str) -> "PathString":
        return PathString(other) / self


def path_member(owner: av.Scalar, name: str) -> av.Value | None:
    """Return a member of a path object; None for what a text has too."""
    path = PurePosixPath(str(owner.value))
    if name in _PATHS:
        return av.Scalar(PathString(getattr(path, name)))
    if name in _TEXTS:
        return av.Scalar(getattr(path, name))
    if name == "parents":
        return av.list_of([av.Scalar(PathString(parent)) for parent in path.parents])
    method = _METHODS.get(name)
    return av.LibraryFunction(name, method, owner) if method is not None else None


def join_paths(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`Path(first, second, …)`."""
    values = arguments.values or (av.Scalar("."),)
    if all(isinstance(value, av.Scalar) for value in values):
        return _path(os.path.join(*(str(value.value) for value in values)))  # type: ignore[union-attr] # noqa: PTH118
    slashed = [part for value in values for part in (av.Scalar("/"), value)][1:]
    return av.concat(slashed)


def _join_to_path(machine: AbstractMachine, owner: av.Scalar, arguments: Arguments) -> av.Value:
    values = (owner, *arguments.values)
    return join_paths(machine, None, arguments.with_values(*values))


def _path(text: str) -> av.Scalar:
    return av.Scalar(PathString(PurePosixPath(text)))


def _change_path(name: str, _: AbstractMachine, owner: av.Scalar, arguments: Arguments) -> av.Value:
    """`with_suffix(text)`, `with_name(text)`, `with_stem(text)`, `relative_to(path)`."""
    argument = arguments.get(0)
    if not isinstance(argument, av.Scalar):
        return av.Unknown(name)
    try:
        return _path(str(getattr(PurePosixPath(str(owner.value)), name)(str(argument.value))))
    except (TypeError, ValueError):
        return av.Unknown(name)


def _read(machine: AbstractMachine, owner: av.Scalar, _: Arguments) -> av.Value:
    text = machine.runtime.files.read_text(Path(str(owner.value)))
    return av.Unknown("file") if text is None else av.Scalar(text, tainted=True)


def _existence(path: av.Value) -> av.Value:
    """Return whether a path is there; what is not may be made by a build, or at run time."""
    if not isinstance(path, av.Scalar):
        return av.Unknown("exists")
    try:
        return av.TRUE if Path(str(path.value)).exists() else av.Unknown("exists")
    except (OSError, ValueError):
        return av.Unknown("exists")


_PATHS, _TEXTS = frozenset({"parent"}), frozenset({"name", "stem", "suffix"})
_METHODS: Mapping[str, Callable[..., av.Value]] = {
    "joinpath": _join_to_path,
    **dict.fromkeys(
        ("absolute", "resolve", "expanduser"),
        lambda _, owner, __: _path(os.path.normpath(str(owner.value))),
    ),
    **dict.fromkeys(
        ("as_posix", "__str__", "__fspath__"), lambda _, owner, __: av.Scalar(str(owner.value))
    ),
    **{
        name: partial(_change_path, name)
        for name in ("with_suffix", "with_name", "with_stem", "relative_to")
    },
    **dict.fromkeys(("exists", "is_file", "is_dir"), lambda _, owner, __: _existence(owner)),
    **dict.fromkeys(("glob", "rglob", "iterdir"), lambda *_: av.list_of((), certain=False)),
    "open": lambda _, owner, ___: av.Instance(FILE, {"path": owner}),
    "read_text": _read,
}
PYTHON_PATHS: Mapping[str, av.Value] = {
    **dict.fromkeys(
        ("pathlib.Path", "pathlib.PurePath", "pathlib.PosixPath"),
        av.LibraryFunction("Path", join_paths),
    ),
    **dict.fromkeys(
        ("os.path.exists", "os.path.isfile", "os.path.isdir"),
        av.LibraryFunction(
            "exists",
            lambda _, __, arguments: av.map_options(arguments.value(0, "path"), _existence),
        ),
    ),
}


def _load_file(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`yaml.load(open(path))`, `json.load(stream)`; JSON is read as the YAML it is."""

    def loaded(stream: av.Value) -> av.Value:
        text = _file_text(machine, stream)
        return _parse(text) if text is not None else av.Unknown("file")

    return av.map_options(arguments.value(0), loaded)


def _dump(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`json.dumps(value)` of a number or a text."""

    def dumped(value: av.Value) -> av.Value:
        if not isinstance(value, av.Scalar) or isinstance(value.value, bytes):
            return av.Unknown("json")
        return av.Scalar(json.dumps(value.value), value.tainted)

    return av.map_options(arguments.value(0), dumped)


def _file_text(machine: AbstractMachine, stream: av.Value) -> str | None:
    if isinstance(stream, av.Instance) and stream.type is FILE:
        path, read = stream.fields["path"], machine.runtime.files.read_text
        return read(Path(str(path.value))) if isinstance(path, av.Scalar) else None
    return str(stream.value) if isinstance(stream, av.Scalar) else None


def _parse(text: str) -> av.Value:
    try:
        documents = parse_yaml(text, "").documents
    except InputError:
        return av.Unknown("file")
    found = documents[0] if documents else None
    return av.Unknown("file") if found is None else abstract_value(plain_value(found), "file")


def _read_file(machine: AbstractMachine, owner: av.Instance, _: Arguments) -> av.Value:
    found = [
        _file_text(machine, av.Instance(FILE, {"path": path}))
        for path in av.options(owner.fields["path"])
    ]
    text = found[0] if len(found) == 1 else None
    return av.Unknown("file") if text is None else av.Scalar(text, tainted=True)


FILE.methods["read"] = _read_file
DATA_FILE_FUNCTIONS: Mapping[str, Callable[..., av.Value]] = {
    "json.dumps": _dump,
    **dict.fromkeys(
        ("yaml.load", "yaml.safe_load", "yaml.full_load", "json.load", "json.loads"), _load_file
    ),
}


_PATH_OF = "path of "


def _folder(machine: AbstractMachine, name: av.Value) -> av.Value:
    files = machine.runtime.files
    path = files.package_path(str(name.value)) if isinstance(name, av.Scalar) else None
    return av.Scalar(str(path)) if path else av.Unknown(f"{_PATH_OF}{av.text_with_holes(name)}")


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

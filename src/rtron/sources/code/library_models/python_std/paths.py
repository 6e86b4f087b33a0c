"""Python's pathlib: a path is a text that knows its parts. Only what is there is looked at."""

import os.path
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path, PurePosixPath

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.python_std.builtin_functions import FILE


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


def _absolute(_: AbstractMachine, owner: av.Scalar, __: Arguments) -> av.Value:
    return _path(os.path.normpath(str(owner.value)))


def _text(_: AbstractMachine, owner: av.Scalar, __: Arguments) -> av.Value:
    return av.Scalar(str(owner.value))


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


def _unknown_listing(_: AbstractMachine, __: av.Scalar, ___: Arguments) -> av.Value:
    return av.list_of((), certain=False)


def _path_exists(_: AbstractMachine, owner: av.Scalar, __: Arguments) -> av.Value:
    return _existence(owner)


def _existence(path: av.Value) -> av.Value:
    """Return whether a path is there; what is not may be made by a build, or at run time."""
    if not isinstance(path, av.Scalar):
        return av.Unknown("exists")
    try:
        return av.TRUE if Path(str(path.value)).exists() else av.Unknown("exists")
    except (OSError, ValueError):
        return av.Unknown("exists")


def _exists_function(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    return av.map_options(arguments.get(0, "path") or av.NONE, _existence)


_PATHS, _TEXTS = frozenset({"parent"}), frozenset({"name", "stem", "suffix"})
_METHODS: Mapping[str, Callable[..., av.Value]] = {
    "joinpath": _join_to_path,
    **dict.fromkeys(("absolute", "resolve", "expanduser"), _absolute),
    **dict.fromkeys(("as_posix", "__str__", "__fspath__"), _text),
    **{
        name: partial(_change_path, name)
        for name in ("with_suffix", "with_name", "with_stem", "relative_to")
    },
    **dict.fromkeys(("exists", "is_file", "is_dir"), _path_exists),
    **dict.fromkeys(("glob", "rglob", "iterdir"), _unknown_listing),
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
        av.LibraryFunction("exists", _exists_function),
    ),
}

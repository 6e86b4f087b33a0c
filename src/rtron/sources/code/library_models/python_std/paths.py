"""Python's pathlib: a path is a text that knows its parts. Only what is there is looked at."""

import os.path
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path, PurePosixPath

from rtron.sources.code.interpreter.abstract_values.items import listed
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    TRUE,
    Hole,
    Instance,
    Known,
    ListValue,
    Native,
    Value,
    concat,
    each,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.python_std.builtin_functions import FILE


class PathText(str):
    """A path object's text."""

    __slots__ = ()

    def __truediv__(self, other: str) -> "PathText":
        return PathText(os.path.join(str(self), str(other)))  # noqa: PTH118 - no path is looked at

    def __rtruediv__(self, other: str) -> "PathText":
        return PathText(other) / self


def path_member(owner: Known, name: str) -> Value | None:
    """Return a member of a path object; None for what a text has too."""
    path = PurePosixPath(str(owner.value))
    if name in _PATHS:
        return Known(PathText(getattr(path, name)))
    if name in _TEXTS:
        return Known(getattr(path, name))
    if name == "parents":
        return listed([Known(PathText(parent)) for parent in path.parents])
    method = _METHODS.get(name)
    return Native(name, method, owner) if method is not None else None


def joined(_: Machine, __: object, arguments: Arguments) -> Value:
    """`Path(first, second, …)`."""
    values = arguments.values or (Known("."),)
    if all(isinstance(value, Known) for value in values):
        return _path(os.path.join(*(str(value.value) for value in values)))  # type: ignore[union-attr] # noqa: PTH118
    slashed = [part for value in values for part in (Known("/"), value)][1:]
    return concat(slashed)


def _join(machine: Machine, owner: Known, arguments: Arguments) -> Value:
    values = (owner, *arguments.values)
    return joined(machine, None, Arguments(values=values, frame=arguments.frame))


def _path(text: str) -> Known:
    return Known(PathText(PurePosixPath(text)))


def _absolute(_: Machine, owner: Known, __: Arguments) -> Value:
    return _path(os.path.normpath(str(owner.value)))


def _text(_: Machine, owner: Known, __: Arguments) -> Value:
    return Known(str(owner.value))


def _changed(name: str, _: Machine, owner: Known, arguments: Arguments) -> Value:
    """`with_suffix(text)`, `with_name(text)`, `with_stem(text)`, `relative_to(path)`."""
    wanted = arguments.get(0)
    if not isinstance(wanted, Known):
        return Hole(name)
    try:
        return _path(str(getattr(PurePosixPath(str(owner.value)), name)(str(wanted.value))))
    except (TypeError, ValueError):
        return Hole(name)


def _opened(_: Machine, owner: Known, __: Arguments) -> Value:
    return Instance(FILE, {"path": owner})


def _read(machine: Machine, owner: Known, _: Arguments) -> Value:
    text = machine.world.files.text(Path(str(owner.value)))
    return Hole("file") if text is None else Known(text, tainted=True)


def _unlisted(_: Machine, __: Known, ___: Arguments) -> Value:
    return ListValue({"items": (), "open": True})


def _is_there(_: Machine, owner: Known, __: Arguments) -> Value:
    return _there(owner)


def _there(path: Value) -> Value:
    """Return whether a path is there; what is not may be made by a build, or at run time."""
    if not isinstance(path, Known):
        return Hole("exists")
    try:
        return TRUE if Path(str(path.value)).exists() else Hole("exists")
    except (OSError, ValueError):
        return Hole("exists")


def _exists(_: Machine, __: object, arguments: Arguments) -> Value:
    return each(arguments.get(0, "path") or NONE, _there)


_PATHS, _TEXTS = frozenset({"parent"}), frozenset({"name", "stem", "suffix"})
_METHODS: Mapping[str, Callable[..., Value]] = {
    "joinpath": _join,
    **dict.fromkeys(("absolute", "resolve", "expanduser"), _absolute),
    **dict.fromkeys(("as_posix", "__str__", "__fspath__"), _text),
    **{
        name: partial(_changed, name)
        for name in ("with_suffix", "with_name", "with_stem", "relative_to")
    },
    **dict.fromkeys(("exists", "is_file", "is_dir"), _is_there),
    **dict.fromkeys(("glob", "rglob", "iterdir"), _unlisted),
    "open": _opened,
    "read_text": _read,
}
PYTHON_PATHS: Mapping[str, Value] = {
    **dict.fromkeys(
        ("pathlib.Path", "pathlib.PurePath", "pathlib.PosixPath"), Native("Path", joined)
    ),
    **dict.fromkeys(
        ("os.path.exists", "os.path.isfile", "os.path.isdir"), Native("exists", _exists)
    ),
}

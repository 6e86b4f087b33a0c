"""Python's standard library, and the tools of ROS that read files and start launches."""

import os.path
from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine, ThrownError
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.command_lines import without_remappings
from rtron.sources.code.library_models.python_std.argument_parsers import (
    ARGUMENT_PARSERS,
    command_line_value,
)
from rtron.sources.code.library_models.python_std.collection_types import PYTHON_COLLECTIONS
from rtron.sources.code.library_models.python_std.data_classes import DATACLASSES
from rtron.sources.code.library_models.python_std.dynamic_code import (
    DYNAMIC_CODE_FUNCTIONS,
    MODULE_FILES,
)
from rtron.sources.code.library_models.python_std.environment import environment_value, getenv
from rtron.sources.code.library_models.python_std.paths import (
    DATA_FILE_FUNCTIONS,
    PACKAGE_PATHS,
    PYTHON_PATHS,
)
from rtron.sources.code.library_models.python_std.processes import PROCESSES, THREADS

__all__ = ["PYTHON_LIBRARY", "command_line_value", "node_constants"]


def _known_texts(values: tuple[av.Value, ...]) -> list[str] | None:
    texts = [str(value.value) for value in values if isinstance(value, av.Scalar)]
    return texts if len(texts) == len(values) else None


def _call_path_function(
    function: Callable[..., str | tuple[str, ...]],
    machine: AbstractMachine,
    _: object,
    arguments: Arguments,
) -> av.Value:
    del machine
    texts = _known_texts(arguments.values)
    if texts is None:
        joined = function is os.path.join
        return av.concat(_with_slashes(arguments.values)) if joined else av.Unknown("path")
    try:
        found = function(*texts)
        is_pair = isinstance(found, tuple)
        return av.list_of(map(av.Scalar, found), "tuple") if is_pair else av.Scalar(found)
    except (TypeError, ValueError):
        return av.Unknown("path")


def _with_slashes(values: tuple[av.Value, ...]) -> list[av.Value]:
    return [part for value in values for part in (av.Scalar("/"), value)][1:]


def _myargv(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`myargv(argv)`: the words without the remappings among them."""
    words = arguments.get(0, "argv") or command_line_value(machine.recorder.site)
    return without_remappings(words)


def _exit(_: AbstractMachine, __: object, ___: Arguments) -> av.Value:
    """`sys.exit()` ends the program, as an exception does."""
    raise ThrownError("SystemExit")


_CALLS: Mapping[str, Callable[..., av.Value]] = {
    **{
        f"os.path.{name}": partial(_call_path_function, getattr(os.path, name))
        for name in ("join", "dirname", "basename", "normpath", "split", "splitext")
    },
    **dict.fromkeys(
        ("os.path.abspath", "os.path.realpath", "os.path.expanduser"),
        partial(_call_path_function, os.path.normpath),
    ),
    "os.getenv": getenv,
    "sys.exit": _exit,
    "os._exit": _exit,
    "rospy.myargv": _myargv,
    **PACKAGE_PATHS,
    **ARGUMENT_PARSERS,
    **DATA_FILE_FUNCTIONS,
    **DYNAMIC_CODE_FUNCTIONS,
    **MODULE_FILES,
    **PROCESSES,
}
PYTHON_LIBRARY: Mapping[str, av.Value] = {
    **DATACLASSES,
    **PYTHON_COLLECTIONS,
    **PYTHON_PATHS,
    **THREADS,
    **{name: av.LibraryFunction(name, call) for name, call in _CALLS.items()},
}


def node_constants(machine: AbstractMachine) -> dict[str, av.Value]:
    """Return the library's variables that depend on the node: its command line, its environment."""
    return {
        "sys.argv": command_line_value(machine.recorder.site),
        "os.environ": environment_value(machine.recorder.site),
        "os.sep": av.Scalar("/"),
        "typing.TYPE_CHECKING": av.Scalar(value=False),
        "sys.version_info.major": av.Scalar(3),
    }

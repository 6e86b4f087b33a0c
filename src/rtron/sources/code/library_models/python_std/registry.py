"""Python's standard library, and the tools of ROS that read files and start launches."""

import os.path
from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.items import items_of, list_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    UNKNOWN,
    Instance,
    LibraryClass,
    LibraryFunction,
    ListValue,
    Scalar,
    Unknown,
    Value,
    concat,
    options,
    text_with_holes,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine, ThrownError
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.command_lines import record_started, shell_words
from rtron.sources.code.library_models.common.trivial_functions import return_none
from rtron.sources.code.library_models.python_std.argument_parsers import (
    ARGUMENT_PARSERS,
    command_line_value,
)
from rtron.sources.code.library_models.python_std.collection_types import PYTHON_COLLECTIONS
from rtron.sources.code.library_models.python_std.data_classes import DATACLASSES
from rtron.sources.code.library_models.python_std.data_files import DATA_FILE_FUNCTIONS
from rtron.sources.code.library_models.python_std.dynamic_code import DYNAMIC_CODE_FUNCTIONS
from rtron.sources.code.library_models.python_std.environment import environment_value, getenv
from rtron.sources.code.library_models.python_std.package_paths import PACKAGE_PATHS
from rtron.sources.code.library_models.python_std.paths import PYTHON_PATHS
from rtron.sources.code.library_models.python_std.threads import THREADS

__all__ = ["PYTHON_LIBRARY", "command_line_value", "node_constants"]


def _known_texts(values: tuple[Value, ...]) -> list[str] | None:
    texts = [str(value.value) for value in values if isinstance(value, Scalar)]
    return texts if len(texts) == len(values) else None


def _call_path_function(
    function: Callable[..., str], machine: AbstractMachine, _: object, arguments: Arguments
) -> Value:
    del machine
    texts = _known_texts(arguments.values)
    if texts is None:
        return (
            concat(_with_slashes(arguments.values)) if function is os.path.join else Unknown("path")
        )
    try:
        return Scalar(function(*texts))
    except (TypeError, ValueError):
        return Unknown("path")


def _with_slashes(values: tuple[Value, ...]) -> list[Value]:
    return [part for value in values for part in (Scalar("/"), value)][1:]


def _myargv(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`myargv(argv)`: the words without the remappings among them."""
    words = arguments.get(0, "argv") or command_line_value(machine.recorder.site)
    items, certain = items_of(words)
    words_left = [item for item in items if ":=" not in text_with_holes(item)]
    return list_of(words_left, certain=certain)


def _exit(_: AbstractMachine, __: object, ___: Arguments) -> Value:
    """`sys.exit()` ends the program, as an exception does."""
    raise ThrownError("SystemExit")


def _run_command(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`os.system("roslaunch …")`, `subprocess.Popen(["roslaunch", …])`."""
    command = arguments.get(0, "args") or NONE
    words = list(map(text_with_holes, command.items)) if isinstance(command, ListValue) else []
    for option in options(command):
        record_started(machine, words or shell_words(text_with_holes(option)), arguments)
    return Unknown("process")


def _launch_parent(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`ROSLaunchParent(uuid, files)`; a file may be `(path, arguments)` (roslaunch API)."""
    files, _certain = items_of(arguments.get(1, "roslaunch_files") or NONE)
    for file in files:
        parts, _certain = items_of(file) if isinstance(file, ListValue) else ((file,), True)
        given = items_of(parts[1])[0] if len(parts) > 1 else ()
        _record_launch(machine, parts[0] if parts else UNKNOWN, given, arguments)
    return Instance(_LAUNCH)


def _record_launch(
    machine: AbstractMachine, path: Value, given: tuple[Value, ...], arguments: Arguments
) -> None:
    for option in options(path):
        if isinstance(option, Scalar):
            words = tuple(text_with_holes(value) for value in given)
            machine.recorder.add_start(str(option.value), words, arguments.evidence)
        else:
            what = f"launch file {text_with_holes(option)}"
            machine.recorder.add_unresolved(what, "its path is not known", arguments.evidence)


def _load_launch(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    _record_launch(machine, arguments.value(0), (), arguments)
    return NONE


def _resolve_launch(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`resolve_launch_arguments([package, file])`: a list of one path; here `package/file`."""
    words, _certain = items_of(arguments.get(0) or NONE)
    texts = _known_texts(words)
    if texts is None:
        return list_of((Unknown("launch file"),))
    return list_of((Scalar("/".join(texts[:2])),))


def _launch_node(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`roslaunch.core.Node(package, node_type, …)`, started by `ROSLaunch().launch(node)`."""
    package, type = (
        text_with_holes(arguments.value(n, k)) for n, k in ((0, "package"), (1, "node_type"))
    )
    machine.recorder.add_start(f"{package}/{type}", ("rosrun",), arguments.evidence)
    return Instance(_LAUNCH)


_LAUNCH = LibraryClass(
    "roslaunch",
    methods={
        "load": _load_launch,
        **dict.fromkeys(("start", "launch", "shutdown", "spin"), return_none),
    },
)


def _make_launch(_: AbstractMachine, __: object, ___: Arguments) -> Value:
    return Instance(_LAUNCH)


_CALLS: Mapping[str, Callable[..., Value]] = {
    **{
        f"os.path.{name}": partial(_call_path_function, getattr(os.path, name))
        for name in ("join", "dirname", "basename", "normpath", "splitext")
    },
    **dict.fromkeys(
        ("os.path.abspath", "os.path.realpath", "os.path.expanduser"),
        partial(_call_path_function, os.path.normpath),
    ),
    "os.getenv": getenv,
    "os.system": _run_command,
    "sys.exit": _exit,
    "os._exit": _exit,
    "os.popen": _run_command,
    **{
        f"subprocess.{n}": _run_command
        for n in ("Popen", "call", "check_call", "check_output", "run")
    },
    "rospy.myargv": _myargv,
    **PACKAGE_PATHS,
    "roslaunch.parent.ROSLaunchParent": _launch_parent,
    "roslaunch.rlutil.resolve_launch_arguments": _resolve_launch,
    "roslaunch.scriptapi.ROSLaunch": _make_launch,
    "roslaunch.ROSLaunch": _make_launch,
    "roslaunch.core.Node": _launch_node,
    "roslaunch.Node": _launch_node,
}
PYTHON_LIBRARY: Mapping[str, Value] = {
    **DATACLASSES,
    **ARGUMENT_PARSERS,
    **PYTHON_COLLECTIONS,
    **DATA_FILE_FUNCTIONS,
    **DYNAMIC_CODE_FUNCTIONS,
    **PYTHON_PATHS,
    **THREADS,
    **{name: LibraryFunction(name, call) for name, call in _CALLS.items()},
}


def node_constants(machine: AbstractMachine) -> dict[str, Value]:
    """Return the library's variables that depend on the node: its command line, its environment."""
    return {
        "sys.argv": command_line_value(machine.recorder.site),
        "os.environ": environment_value(machine.recorder.site),
        "os.sep": Scalar("/"),
        "sys.version_info.major": Scalar(3),
    }

"""Python's standard library, and the tools of ROS that read files and start launches."""

import os.path
from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.items import items_of, listed
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Hole,
    Instance,
    Known,
    ListValue,
    Native,
    NativeClass,
    Value,
    concat,
    options,
    spelled,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine, ThrownError
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.command_lines import shell_words, started_by_words
from rtron.sources.code.library_models.python_std.argument_parsers import (
    PYTHON_ARGUMENTS,
    command_line,
)
from rtron.sources.code.library_models.python_std.collection_types import PYTHON_COLLECTIONS
from rtron.sources.code.library_models.python_std.data_files import PYTHON_FILES
from rtron.sources.code.library_models.python_std.dataclass import DATACLASSES
from rtron.sources.code.library_models.python_std.dynamic_code import PYTHON_HIDDEN
from rtron.sources.code.library_models.python_std.environment import environment, getenv
from rtron.sources.code.library_models.python_std.paths import PYTHON_PATHS
from rtron.sources.code.library_models.python_std.threads import THREADS

__all__ = ["PYTHON_LIBRARY", "command_line", "constants"]


def _known(values: tuple[Value, ...]) -> list[str] | None:
    texts = [str(value.value) for value in values if isinstance(value, Known)]
    return texts if len(texts) == len(values) else None


def _path(function: Callable[..., str], machine: Machine, _: object, arguments: Arguments) -> Value:
    del machine
    texts = _known(arguments.values)
    if texts is None:
        return concat(_slashed(arguments.values)) if function is os.path.join else Hole("path")
    try:
        return Known(function(*texts))
    except (TypeError, ValueError):
        return Hole("path")


def _slashed(values: tuple[Value, ...]) -> list[Value]:
    return [part for value in values for part in (Known("/"), value)][1:]


def _myargv(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`myargv(argv)`: the words without the remappings among them."""
    words = arguments.get(0, "argv") or command_line(machine.recorder.site)
    items, certain = items_of(words)
    kept = [item for item in items if ":=" not in spelled(item)]
    return ListValue({"items": tuple(kept), "open": not certain})


def _exit(_: Machine, __: object, ___: Arguments) -> Value:
    """`sys.exit()` ends the program, as an exception does."""
    raise ThrownError("SystemExit")


def _package_path(machine: Machine, _: object, arguments: Arguments) -> Value:
    name = arguments.get(0)
    if isinstance(name, Known):
        path = machine.world.files.package_path(str(name.value))
        if path is not None:
            return Known(str(path))
    return Hole(f"path of {spelled(name or NONE)}")


def _rospack(_: Machine, __: object, ___: Arguments) -> Value:
    return Instance(_ROSPACK)


def _run(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`os.system("roslaunch …")`, `subprocess.Popen(["roslaunch", …])`."""
    command = arguments.get(0, "args") or NONE
    words = [spelled(item) for item in command.items] if isinstance(command, ListValue) else None
    for option in options(command):
        started_by_words(machine, words or shell_words(spelled(option)), arguments)
    return Hole("process")


def _launch_parent(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`ROSLaunchParent(uuid, files)`; a file may be `(path, arguments)` (roslaunch API)."""
    files, _certain = items_of(arguments.get(1, "roslaunch_files") or NONE)
    for file in files:
        parts, _certain = items_of(file) if isinstance(file, ListValue) else ((file,), True)
        given = items_of(parts[1])[0] if len(parts) > 1 else ()
        _start(machine, parts[0] if parts else Hole("?"), given, arguments)
    return Instance(_LAUNCH)


def _start(machine: Machine, path: Value, given: tuple[Value, ...], arguments: Arguments) -> None:
    for option in options(path):
        if isinstance(option, Known):
            words = tuple(spelled(value) for value in given)
            machine.recorder.start(str(option.value), words, arguments.evidence)
        else:
            what = f"launch file {spelled(option)}"
            machine.recorder.unresolved(what, "its path is not known", arguments.evidence)


def _launch_load(machine: Machine, _: object, arguments: Arguments) -> Value:
    _start(machine, arguments.get(0) or Hole("?"), (), arguments)
    return NONE


def _resolve_launch(_: Machine, __: object, arguments: Arguments) -> Value:
    """`resolve_launch_arguments([package, file])`: a list of one path; here `package/file`."""
    words, _certain = items_of(arguments.get(0) or NONE)
    texts = _known(words)
    if texts is None:
        return listed((Hole("launch file"),))
    return listed((Known("/".join(texts[:2])),))


def _launch_node(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`roslaunch.core.Node(package, node_type, …)`, started by `ROSLaunch().launch(node)`."""
    package, type = (
        spelled(arguments.get(n, k) or Hole("?")) for n, k in ((0, "package"), (1, "node_type"))
    )
    machine.recorder.start(f"{package}/{type}", ("rosrun",), arguments.evidence)
    return Instance(_LAUNCH)


_ROSPACK = NativeClass("rospkg.RosPack", methods={"get_path": _package_path})
_LAUNCH = NativeClass(
    "roslaunch",
    methods={
        "load": _launch_load,
        **{n: (lambda m, o, a: NONE) for n in ("start", "launch", "shutdown", "spin")},
    },
)


def _launcher(_: Machine, __: object, ___: Arguments) -> Value:
    return Instance(_LAUNCH)


_CALLS: Mapping[str, Callable[..., Value]] = {
    **{
        f"os.path.{name}": partial(_path, getattr(os.path, name))
        for name in ("join", "dirname", "basename", "normpath", "splitext")
    },
    **dict.fromkeys(
        ("os.path.abspath", "os.path.realpath", "os.path.expanduser"),
        partial(_path, os.path.normpath),
    ),
    "os.getenv": getenv,
    "os.system": _run,
    "sys.exit": _exit,
    "os._exit": _exit,
    "os.popen": _run,
    **{f"subprocess.{n}": _run for n in ("Popen", "call", "check_call", "check_output", "run")},
    "rospy.myargv": _myargv,
    "rospkg.RosPack": _rospack,
    "rospkg.rospack.RosPack": _rospack,
    "roslib.packages.get_pkg_dir": _package_path,
    "roslib.packages.get_dir_pkg": _package_path,
    "roslaunch.parent.ROSLaunchParent": _launch_parent,
    "roslaunch.rlutil.resolve_launch_arguments": _resolve_launch,
    "roslaunch.scriptapi.ROSLaunch": _launcher,
    "roslaunch.ROSLaunch": _launcher,
    "roslaunch.core.Node": _launch_node,
    "roslaunch.Node": _launch_node,
}
PYTHON_LIBRARY: Mapping[str, Value] = {
    **DATACLASSES,
    **PYTHON_ARGUMENTS,
    **PYTHON_COLLECTIONS,
    **PYTHON_FILES,
    **PYTHON_HIDDEN,
    **PYTHON_PATHS,
    **THREADS,
    **{name: Native(name, call) for name, call in _CALLS.items()},
}


def constants(machine: Machine) -> dict[str, Value]:
    """Return the library's variables that depend on the node: its command line, its environment."""
    return {
        "sys.argv": command_line(machine.recorder.site),
        "os.environ": environment(machine.recorder.site),
        "os.sep": Known("/"),
        "sys.version_info.major": Known(3),
    }

"""The processes and launch files that a Python program starts (ROS wiki: roslaunch API)."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.library_models.common.command_lines import record_started, shell_words
from rtron.sources.code.library_models.common.trivial_functions import (
    making,
    return_argument,
    return_none,
)
from rtron.sources.code.library_models.python_std.argument_parsers import command_line_value
from rtron.sources.code.library_models.python_std.builtin_functions import BUILTINS
from rtron.sources.code.library_models.python_std.paths import missing_package
from rtron.vocabulary.enums import HiddenPart


def run_words(
    machine: AbstractMachine, words: tuple[av.Value, ...], at: Arguments, *, certain: bool = True
) -> None:
    """Record what a command of these words starts; further ones may be there unless `certain`."""
    rest = () if certain else ("{?}",)
    record_started(machine, [*map(av.text_with_holes, words), *rest], at)


def _run_command(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`os.system("roslaunch …")`, `subprocess.Popen(["roslaunch", …])`."""
    for command in av.options(arguments.get(0, "args") or arguments.get(0, "command") or av.NONE):
        if isinstance(command, av.ListValue):
            run_words(machine, command.items, arguments, certain=not command.open)
        else:
            record_started(machine, shell_words(av.text_with_holes(command)), arguments)
    return av.Unknown("process")


def _run_arguments(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`create_subprocess_exec("roslaunch", …)`."""
    run_words(machine, arguments.values, arguments)
    return av.Unknown("process")


_RUNNERS = (
    *("os.system", "os.popen", "commands.getoutput", "pexpect.spawn", "psutil.Popen"),
    *("asyncio.create_subprocess_shell", "subprocess.getoutput", "subprocess.getstatusoutput"),
    *(f"subprocess.{name}" for name in ("Popen", "call", "check_call", "check_output", "run")),
)


def _main(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`roslaunch.main(["roslaunch", package, file, …])`: the same as the command."""
    given = arguments.get(0, "argv") or command_line_value(machine.recorder.site)
    words, certain = av.items_of(given)
    run_words(machine, (av.Scalar("roslaunch"), *words[1:]), arguments, certain=certain)
    return av.NONE


def _launch_parent(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`ROSLaunchParent(uuid, files)`; a file may be `(path, arguments)`."""
    _record_files(machine, arguments.get(1, "roslaunch_files") or av.NONE, arguments)
    if arguments.get(8, "roslaunch_strs") not in {None, av.NONE}:
        _note_text(machine, None, arguments)
    return av.Instance(_LAUNCH)


def _record_files(machine: AbstractMachine, given: av.Value, arguments: Arguments) -> None:
    files, certain = av.items_of(given)
    for file in files:
        parts = av.items_of(file)[0] if isinstance(file, av.ListValue) else (file,)
        words = av.items_of(parts[1])[0] if len(parts) > 1 else ()
        _record_launch(machine, parts[0] if parts else av.UNKNOWN, words, arguments)
    if not certain:
        _record_launch(machine, av.UNKNOWN, (), arguments)


def _record_launch(
    machine: AbstractMachine, path: av.Value, given: tuple[av.Value, ...], arguments: Arguments
) -> None:
    for option in av.options(path):
        if isinstance(option, av.Scalar):
            words = tuple(av.text_with_holes(value) for value in given)
            machine.recorder.add_start(str(option.value), words, arguments.evidence)
        else:
            what = f"launch file {av.text_with_holes(option)}"
            why, hides, package = "its path is not known", HiddenPart.NODES, missing_package(option)
            machine.recorder.add_unresolved(
                what, why, arguments.evidence, hides=hides, package=package
            )


def _load_launch(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    _record_launch(machine, arguments.value(0), (), arguments)
    return av.NONE


def _note_text(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    what, why = "launch file as a text", "what a program launches from a text is not followed"
    machine.recorder.add_unresolved(what, why, arguments.evidence, hides=HiddenPart.NODES)
    return av.NONE


def _resolve_launch(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`resolve_launch_arguments([package, file])`: a list of one path; here `package/file`."""
    words, certain = av.items_of(arguments.get(0) or av.NONE)
    texts = [str(word.value) for word in words if isinstance(word, av.Scalar)]
    if not certain or not texts or len(texts) < len(words[:2]):
        return av.list_of((av.Unknown("launch file"),))
    return av.list_of((av.Scalar("/".join(texts[:2])),))


def _launch_node(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`roslaunch.core.Node(package, node_type, …)`, started by `ROSLaunch().launch(node)`."""
    package, type = (
        av.text_with_holes(arguments.value(n, k)) for n, k in ((0, "package"), (1, "node_type"))
    )
    if "{" in package + type:
        what = f"node {package}/{type}"
        machine.recorder.add_unresolved(
            what, "which program it is is not known", arguments.evidence
        )
    else:
        words = ("rosrun", *_node_words(arguments))
        machine.recorder.add_start(f"{package}/{type}", words, arguments.evidence)
    return av.Instance(_LAUNCH)


def _node_words(arguments: Arguments) -> Iterator[str]:
    """Yield a node's arguments and remaps as a command line has them."""
    given = arguments.get(5, "args") or av.Scalar("")
    yield from shell_words(av.text_with_holes(given)) if given != av.Scalar("") else ()
    for pair in av.items_of(arguments.get(8, "remap_args") or av.NONE)[0]:
        yield ":=".join(map(av.text_with_holes, av.items_of(pair)[0]))
    for at, key, word in ((2, "name", "__name"), (3, "namespace", "__ns")):
        value = arguments.get(at, key)
        if value is not None and value not in (av.NONE, av.Scalar("/")):
            yield f"{word}:={av.text_with_holes(value)}"


_LAUNCH = av.LibraryClass(
    "roslaunch",
    methods={
        "load": _load_launch,
        "load_str": _note_text,
        "load_string": _note_text,
        **dict.fromkeys(("start", "launch", "shutdown", "spin", "spin_once"), return_none),
    },
)
_LAUNCH_NAMES = (*("roslaunch.scriptapi.ROSLaunch", "roslaunch.ROSLaunch"),)
PROCESSES: Mapping[str, Callable[..., av.Value]] = {
    **dict.fromkeys(_RUNNERS, _run_command),
    "asyncio.create_subprocess_exec": _run_arguments,
    "roslaunch.main": _main,
    **dict.fromkeys(
        ("roslaunch.parent.ROSLaunchParent", "roslaunch.ROSLaunchParent"), _launch_parent
    ),
    "roslaunch.rlutil.resolve_launch_arguments": _resolve_launch,
    **dict.fromkeys(_LAUNCH_NAMES, making(_LAUNCH)),
    **dict.fromkeys(("roslaunch.core.Node", "roslaunch.Node"), _launch_node),
}


def _run_target(
    keyword: str,
    positions: tuple[int, int, int],
    machine: AbstractMachine,
    _: object,
    arguments: Arguments,
) -> av.Value:
    """Run a function beside the program; `positions` are its own, that of its values and words."""
    at, args, kwargs = positions
    given = av.items_of(arguments.get(args, "args") or av.NONE)[0]
    named = arguments.get(kwargs, "kwargs")
    keywords = {str(k): v for k, v in getattr(named, "entries", {}).items()}
    for option in av.options(arguments.get(at, keyword)):
        if isinstance(option, (av.LibraryFunction, av.ClassValue)):
            dispatch(machine, option, replace(arguments, values=given, keywords=keywords))
        elif isinstance(option, av.Instance):
            machine.escape(option)
        elif isinstance(option, av.FunctionValue):
            values = (*option.bound_arguments, *given)
            passed = {**option.bound_keywords, **keywords}
            machine.escape(replace(option, bound_arguments=values, bound_keywords=passed))
    return av.NONE


def _start_thread(machine: AbstractMachine, owner: av.Instance, _: Arguments) -> av.Value:
    """Run the method `run` that a class of threads defines itself."""
    machine.escape(machine.runtime.attribute(owner, "run", ()))
    return av.NONE


def _thread_class(name: str, keyword: str, positions: tuple[int, int, int]) -> av.LibraryClass:
    run = partial(_run_target, keyword, positions)

    def make(machine: AbstractMachine, arguments: Arguments) -> av.Value:
        run(machine, None, arguments)
        return av.Instance(made)

    made: av.LibraryClass = av.LibraryClass(name, make, {"__init__": run, "start": _start_thread})
    return made


def _submit(machine: AbstractMachine, _: av.Instance, arguments: Arguments) -> av.Value:
    """`executor.submit(function, …)`: what it returns has the result."""
    made = dispatch(machine, arguments.value(0), arguments.without_first(1))
    return av.Instance(_FUTURE, {"result": av.LibraryFunction("result", lambda *_: made)})


_FUTURE = av.LibraryClass("concurrent.futures.Future")
_EXECUTOR: av.LibraryClass = av.LibraryClass(
    "concurrent.futures.Executor",
    lambda _machine, _arguments: av.Instance(_EXECUTOR),
    {
        "submit": _submit,
        "map": lambda machine, _, arguments: dispatch(machine, BUILTINS["map"], arguments),
    },
)
THREAD = _thread_class("threading.Thread", "target", (1, 3, 4))
_START = av.LibraryFunction("thread.start_new_thread", partial(_run_target, "function", (0, 1, 2)))
THREADS: Mapping[str, av.Value] = {
    "threading.Thread": THREAD,
    "threading.Timer": _thread_class("threading.Timer", "function", (1, 2, 3)),
    "multiprocessing.Process": THREAD,
    **{f"concurrent.futures.{kind}PoolExecutor": _EXECUTOR for kind in ("Thread", "Process")},
    "asyncio.run": av.LibraryFunction("asyncio.run", return_argument),
    **dict.fromkeys(("thread.start_new_thread", "_thread.start_new_thread"), _START),
}

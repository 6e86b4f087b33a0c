"""Processes that a Python program starts: the commands of ROS among them start nodes."""

from collections.abc import Callable, Mapping

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine, ThrownError
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.command_lines import record_started, shell_words


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


def _become_list(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`os.execvp(file, words)`: the program goes no further."""
    words, certain = av.items_of(arguments.value(1))
    run_words(machine, (arguments.value(0), *words[1:]), arguments, certain=certain)
    raise ThrownError("SystemExit")


def _become_words(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`os.execlp(file, word, …)`."""
    run_words(machine, (arguments.value(0), *arguments.values[2:]), arguments)
    raise ThrownError("SystemExit")


def _spawn_list(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`os.spawnvp(mode, file, words)`."""
    words, certain = av.items_of(arguments.value(2))
    run_words(machine, (arguments.value(1), *words[1:]), arguments, certain=certain)
    return av.Unknown("process")


def _spawn_words(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`os.spawnlp(mode, file, word, …)`."""
    run_words(machine, (arguments.value(1), *arguments.values[3:]), arguments)
    return av.Unknown("process")


_RUNNERS = (
    *("os.system", "os.popen", "commands.getoutput", "pexpect.spawn", "psutil.Popen"),
    *("asyncio.create_subprocess_shell", "subprocess.getoutput", "subprocess.getstatusoutput"),
    *(f"subprocess.{name}" for name in ("Popen", "call", "check_call", "check_output", "run")),
)
_CALLS: Mapping[str, Callable[..., av.Value]] = {
    **dict.fromkeys(_RUNNERS, _run_command),
    "asyncio.create_subprocess_exec": _run_arguments,
    **{f"os.exec{kind}": _become_list for kind in ("v", "vp", "ve", "vpe")},
    **{f"os.exec{kind}": _become_words for kind in ("l", "lp")},
    **{f"os.spawn{kind}": _spawn_list for kind in ("v", "vp", "ve", "vpe")},
    **{f"os.spawn{kind}": _spawn_words for kind in ("l", "lp")},
}
PROCESSES: Mapping[str, av.Value] = {
    name: av.LibraryFunction(name, call) for name, call in _CALLS.items()
}

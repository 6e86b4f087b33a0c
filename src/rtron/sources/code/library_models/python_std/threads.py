"""Python's threads and processes: what runs in them runs beside the program."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.library_models.common.trivial_functions import return_argument
from rtron.sources.code.library_models.python_std.builtin_functions import BUILTINS


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

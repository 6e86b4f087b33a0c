"""Python's threads and processes: what runs in them runs beside the program."""

from collections.abc import Mapping
from dataclasses import replace

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.library_models.common.trivial_functions import return_argument
from rtron.sources.code.library_models.python_std.builtin_functions import BUILTINS


def _escape_target(
    machine: AbstractMachine,
    target: av.Value | None,
    args: av.Value | None,
    named: av.Value | None,
    at: Arguments,
) -> None:
    given = av.items_of(args)[0] if args is not None else ()
    keywords = (
        {str(k): v for k, v in named.entries.items()} if isinstance(named, av.MapValue) else {}
    )
    for option in av.options(target):
        if isinstance(option, (av.LibraryFunction, av.ClassValue)):
            dispatch(machine, option, replace(at, values=given, keywords=keywords))
        elif isinstance(option, av.Instance):
            machine.escape(option)
        elif isinstance(option, av.FunctionValue):
            passed = {**option.bound_keywords, **keywords}
            machine.escape(
                replace(
                    option, bound_arguments=(*option.bound_arguments, *given), bound_keywords=passed
                )
            )


def _make_thread_target(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`Thread(group, target, name, args, kwargs)`."""
    args, named = arguments.get(3, "args"), arguments.get(4, "kwargs")
    _escape_target(machine, arguments.get(1, "target"), args, named, arguments)
    return av.NONE


def _make_timer_target(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`Timer(interval, function, args, kwargs)`."""
    args, named = arguments.get(2, "args"), arguments.get(3, "kwargs")
    _escape_target(machine, arguments.get(1, "function"), args, named, arguments)
    return av.NONE


def _start_new_thread(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`thread.start_new_thread(function, args, kwargs)`."""
    given = (arguments.get(1), arguments.get(2))
    _escape_target(machine, arguments.get(0), *given, arguments)
    return av.Unknown("thread")


def _start_thread(machine: AbstractMachine, owner: av.Instance, _: Arguments) -> av.Value:
    """Run the method `run` that a class of threads defines itself."""
    machine.escape(machine.runtime.attribute(owner, "run", ()))
    return av.NONE


def _make_thread(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    _make_thread_target(machine, None, arguments)
    return av.Instance(THREAD)


def _make_timer(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    _make_timer_target(machine, None, arguments)
    return av.Instance(_TIMER)


def _submit(machine: AbstractMachine, _: av.Instance, arguments: Arguments) -> av.Value:
    """`executor.submit(function, …)`: what it returns has the result."""
    made = dispatch(machine, arguments.value(0), arguments.without_first(1))
    return av.Instance(_FUTURE, {"result": av.LibraryFunction("result", lambda *_: made)})


def _map(machine: AbstractMachine, _: av.Instance, arguments: Arguments) -> av.Value:
    return dispatch(machine, BUILTINS["map"], arguments)


def _make_executor(_: AbstractMachine, __: Arguments) -> av.Value:
    return av.Instance(_EXECUTOR)


_FUTURE = av.LibraryClass("concurrent.futures.Future")
_EXECUTOR = av.LibraryClass(
    "concurrent.futures.Executor", _make_executor, {"submit": _submit, "map": _map}
)
THREAD = av.LibraryClass(
    "threading.Thread", _make_thread, {"__init__": _make_thread_target, "start": _start_thread}
)
_TIMER = av.LibraryClass(
    "threading.Timer", _make_timer, {"__init__": _make_timer_target, "start": _start_thread}
)
THREADS: Mapping[str, av.Value] = {
    "threading.Thread": THREAD,
    "threading.Timer": _TIMER,
    "multiprocessing.Process": THREAD,
    **{f"concurrent.futures.{kind}PoolExecutor": _EXECUTOR for kind in ("Thread", "Process")},
    "asyncio.run": av.LibraryFunction("asyncio.run", return_argument),
    "thread.start_new_thread": av.LibraryFunction("thread.start_new_thread", _start_new_thread),
    "_thread.start_new_thread": av.LibraryFunction("thread.start_new_thread", _start_new_thread),
}

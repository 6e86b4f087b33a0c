"""Python's threads and processes: what runs in them runs beside the program."""

from collections.abc import Mapping
from dataclasses import replace

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    ClassValue,
    FunctionValue,
    Instance,
    LibraryClass,
    LibraryFunction,
    MapValue,
    Unknown,
    Value,
    options,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.library_models.common.trivial_functions import return_argument
from rtron.sources.code.library_models.python_std.builtin_functions import BUILTINS


def _escape_target(
    machine: AbstractMachine,
    target: Value | None,
    args: Value | None,
    named: Value | None,
    at: Arguments,
) -> None:
    given = items_of(args)[0] if args is not None else ()
    keywords = {str(k): v for k, v in named.entries.items()} if isinstance(named, MapValue) else {}
    for option in options(target):
        if isinstance(option, (LibraryFunction, ClassValue)):
            dispatch(machine, option, replace(at, values=given, keywords=keywords))
        elif isinstance(option, Instance):
            machine.escape(option)
        elif isinstance(option, FunctionValue):
            passed = {**option.bound_keywords, **keywords}
            machine.escape(
                replace(
                    option, bound_arguments=(*option.bound_arguments, *given), bound_keywords=passed
                )
            )


def _make_thread_target(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`Thread(group, target, name, args, kwargs)`."""
    args, named = arguments.get(3, "args"), arguments.get(4, "kwargs")
    _escape_target(machine, arguments.get(1, "target"), args, named, arguments)
    return NONE


def _make_timer_target(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`Timer(interval, function, args, kwargs)`."""
    args, named = arguments.get(2, "args"), arguments.get(3, "kwargs")
    _escape_target(machine, arguments.get(1, "function"), args, named, arguments)
    return NONE


def _start_new_thread(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`thread.start_new_thread(function, args, kwargs)`."""
    given = (arguments.get(1), arguments.get(2))
    _escape_target(machine, arguments.get(0), *given, arguments)
    return Unknown("thread")


def _start_thread(machine: AbstractMachine, owner: Instance, _: Arguments) -> Value:
    """Run the method `run` that a class of threads defines itself."""
    machine.escape(machine.runtime.attribute(owner, "run", ()))
    return NONE


def _make_thread(machine: AbstractMachine, arguments: Arguments) -> Value:
    _make_thread_target(machine, None, arguments)
    return Instance(THREAD)


def _make_timer(machine: AbstractMachine, arguments: Arguments) -> Value:
    _make_timer_target(machine, None, arguments)
    return Instance(_TIMER)


def _submit(machine: AbstractMachine, _: Instance, arguments: Arguments) -> Value:
    """`executor.submit(function, …)`: what it returns has the result."""
    made = dispatch(machine, arguments.value(0), arguments.without_first(1))
    return Instance(_FUTURE, {"result": LibraryFunction("result", lambda *_: made)})


def _map(machine: AbstractMachine, _: Instance, arguments: Arguments) -> Value:
    return dispatch(machine, BUILTINS["map"], arguments)


def _make_executor(_: AbstractMachine, __: Arguments) -> Value:
    return Instance(_EXECUTOR)


_FUTURE = LibraryClass("concurrent.futures.Future")
_EXECUTOR = LibraryClass(
    "concurrent.futures.Executor", _make_executor, {"submit": _submit, "map": _map}
)
THREAD = LibraryClass(
    "threading.Thread", _make_thread, {"__init__": _make_thread_target, "start": _start_thread}
)
_TIMER = LibraryClass(
    "threading.Timer", _make_timer, {"__init__": _make_timer_target, "start": _start_thread}
)
THREADS: Mapping[str, Value] = {
    "threading.Thread": THREAD,
    "threading.Timer": _TIMER,
    "multiprocessing.Process": THREAD,
    **{f"concurrent.futures.{kind}PoolExecutor": _EXECUTOR for kind in ("Thread", "Process")},
    "asyncio.run": LibraryFunction("asyncio.run", return_argument),
    "thread.start_new_thread": LibraryFunction("thread.start_new_thread", _start_new_thread),
    "_thread.start_new_thread": LibraryFunction("thread.start_new_thread", _start_new_thread),
}

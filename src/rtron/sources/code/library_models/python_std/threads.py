"""Python's threads and processes: what runs in them runs beside the program."""

from collections.abc import Mapping
from dataclasses import replace

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
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


def _escape_target(
    machine: AbstractMachine, target: Value | None, args: Value | None, named: Value | None
) -> None:
    given = items_of(args)[0] if args is not None else ()
    keywords = {str(k): v for k, v in named.entries.items()} if isinstance(named, MapValue) else {}
    for option in options(target):
        if isinstance(option, FunctionValue):
            passed = {**option.bound_keywords, **keywords}
            machine.escape(
                replace(
                    option, bound_arguments=(*option.bound_arguments, *given), bound_keywords=passed
                )
            )


def _make_thread_target(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`Thread(group, target, name, args, kwargs)`."""
    args, named = arguments.get(3, "args"), arguments.get(4, "kwargs")
    _escape_target(machine, arguments.get(1, "target"), args, named)
    return NONE


def _make_timer_target(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`Timer(interval, function, args, kwargs)`."""
    args, named = arguments.get(2, "args"), arguments.get(3, "kwargs")
    _escape_target(machine, arguments.get(1, "function"), args, named)
    return NONE


def _start_new_thread(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`thread.start_new_thread(function, args, kwargs)`."""
    _escape_target(machine, arguments.get(0), arguments.get(1), arguments.get(2))
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
    "thread.start_new_thread": LibraryFunction("thread.start_new_thread", _start_new_thread),
    "_thread.start_new_thread": LibraryFunction("thread.start_new_thread", _start_new_thread),
}

"""Python's threads and processes: what runs in them runs beside the program."""

from collections.abc import Mapping
from dataclasses import replace

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    FunctionValue,
    Hole,
    Instance,
    MapValue,
    Native,
    NativeClass,
    Value,
    options,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments


def _beside(
    machine: Machine, target: Value | None, args: Value | None, named: Value | None
) -> None:
    given = items_of(args)[0] if args is not None else ()
    keywords = {str(k): v for k, v in named.entries.items()} if isinstance(named, MapValue) else {}
    for option in options(target):
        if isinstance(option, FunctionValue):
            passed = {**option.named, **keywords}
            machine.escape(replace(option, given=(*option.given, *given), named=passed))


def _thread(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`Thread(group, target, name, args, kwargs)`."""
    args, named = arguments.get(3, "args"), arguments.get(4, "kwargs")
    _beside(machine, arguments.get(1, "target"), args, named)
    return NONE


def _timer(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`Timer(interval, function, args, kwargs)`."""
    args, named = arguments.get(2, "args"), arguments.get(3, "kwargs")
    _beside(machine, arguments.get(1, "function"), args, named)
    return NONE


def _started(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`thread.start_new_thread(function, args, kwargs)`."""
    _beside(machine, arguments.get(0), arguments.get(1), arguments.get(2))
    return Hole("thread")


def _start(machine: Machine, owner: Instance, _: Arguments) -> Value:
    """Run the method `run` that a class of threads defines itself."""
    machine.escape(machine.world.attribute(owner, "run", ()))
    return NONE


def _make(machine: Machine, arguments: Arguments) -> Value:
    _thread(machine, None, arguments)
    return Instance(THREAD)


def _make_timer(machine: Machine, arguments: Arguments) -> Value:
    _timer(machine, None, arguments)
    return Instance(_TIMER)


THREAD = NativeClass("threading.Thread", _make, {"__init__": _thread, "start": _start})
_TIMER = NativeClass("threading.Timer", _make_timer, {"__init__": _timer, "start": _start})
THREADS: Mapping[str, Value] = {
    "threading.Thread": THREAD,
    "threading.Timer": _TIMER,
    "multiprocessing.Process": THREAD,
    "thread.start_new_thread": Native("thread.start_new_thread", _started),
    "_thread.start_new_thread": Native("thread.start_new_thread", _started),
}

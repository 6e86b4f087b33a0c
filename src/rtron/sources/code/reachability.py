"""What runs that the program itself does not call: callbacks, threads, methods a library calls."""

from collections.abc import Iterator

from rtron.sources.code.interpreter.arguments import Arguments
from rtron.sources.code.interpreter.calling import dispatch
from rtron.sources.code.interpreter.frame import Frame
from rtron.sources.code.interpreter.machine import Machine
from rtron.sources.code.interpreter.values import (
    ClassValue,
    Foreign,
    FunctionValue,
    Hole,
    Instance,
    Value,
)
from rtron.sources.code.ir import Class, Function
from rtron.sources.code.words import called_words

API = frozenset(
    "advertise subscribe advertiseService serviceClient advertiseCamera subscribeCamera Publisher "
    "Subscriber Service ServiceProxy waitForMessage wait_for_message createInstance system Popen "
    "createClassInstance createUnmanagedInstance ROSLaunchParent launch check_call call popen "
    "SimpleActionClient SimpleActionServer ActionClient ActionServer TransformListener "
    "TransformBroadcaster StaticTransformBroadcaster Server Updater ImageTransport create "
    "RealtimePublisher InteractiveMarkerServer Bond SubscriberFilter SimpleActionServer<>".split()
)
MAX_RUNS = 400


def run_pending(machine: Machine) -> None:
    """Run what was handed to a library, and the methods that an unknown base class may call."""
    for _ in range(MAX_RUNS):
        waiting = next(_waiting(machine), None)
        if waiting is None:
            return
        frame = Frame(file=waiting.function.file)
        machine.ran.add(_key(waiting.function))
        dispatch(machine, waiting, Arguments(frame=frame))


def _waiting(machine: Machine) -> Iterator[FunctionValue]:
    while machine.pending:
        callback = machine.pending.pop(0)
        if _counts(machine, callback.function):
            yield callback
    for instance in list(machine.instances):
        if isinstance(instance, Instance) and _has_unknown_base(machine, instance):
            for method in _methods(machine, instance):
                if _counts(machine, method.function):
                    yield method


def _key(function: Function) -> tuple[str, int, str]:
    return function.file, function.line, function.name


def _counts(machine: Machine, function: Function) -> bool:
    return _key(function) not in machine.ran and joins_nodes(machine, function)


def joins_nodes(machine: Machine, function: Function) -> bool:
    """Tell whether a function, or what it may call by name, declares anything."""
    seen: set[tuple[str, int, str]] = set()
    queue = [function]
    while queue:
        current = queue.pop()
        if _key(current) in seen:
            continue
        seen.add(_key(current))
        words = called_words(current)
        if words & API:
            return True
        queue.extend(other for word in words for other in machine.world.named(word))
    return False


def _has_unknown_base(machine: Machine, instance: Instance) -> bool:
    lineage = list(machine.world.lineage(instance.type))
    return any(isinstance(cls, (Foreign, Hole)) and not _is_object(cls) for cls in lineage)


def _is_object(cls: Value) -> bool:
    return isinstance(cls, Foreign) and cls.name == "object"


def _methods(machine: Machine, instance: Instance) -> Iterator[FunctionValue]:
    for cls in machine.world.lineage(instance.type):
        if isinstance(cls, ClassValue):
            for name in _names(machine, cls.definition):
                found = machine.world.attribute(instance, name, ())
                if isinstance(found, FunctionValue):
                    yield found


def _names(machine: Machine, definition: Class) -> list[str]:
    return machine.world.method_names(definition)

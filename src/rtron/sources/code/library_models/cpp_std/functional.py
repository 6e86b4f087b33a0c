"""What C++ calls for others: bind, threads, other programs."""

from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    FunctionValue,
    Hole,
    Instance,
    Known,
    NativeClass,
    Value,
    options,
    spelled,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine, ThrownError
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.ir import TypeRef
from rtron.sources.code.library_models.common.command_lines import shell_words, started_by_words
from rtron.sources.code.library_models.common.cpp import cpp

_HIDDEN = "runs or registers what the source does not show"


def same(_: Machine, __: object, arguments: Arguments) -> Value:
    """Return what is given: `std::move(x)`, `std::ref(x)`."""
    return arguments.get(0) or NONE


def bind(_: Machine, __: object, arguments: Arguments) -> Value:
    """`boost::bind(&C::method, object, _1)`: the method, bound to the object (boost: bind)."""
    called, given = arguments.get(0), arguments.values[1:]
    if not isinstance(called, FunctionValue):
        return Hole("bind")
    is_method = called.owner is None and "::" in called.function.name and not called.function.static
    if is_method and given and isinstance(given[0], Instance):
        return _method(called, given[0], given[1:])
    if called.owner is not None and given and given[0] is called.owner:
        given = given[1:]
    return FunctionValue(
        called.function,
        called.closure,
        called.owner,
        given,
        called.cls,
        called.types,
        called.overloads,
    )


def _method(called: FunctionValue, owner: Instance, given: tuple[Value, ...]) -> FunctionValue:
    cls = called.cls or (owner.type if not isinstance(owner.type, NativeClass) else None)
    return FunctionValue(
        called.function, called.closure, owner, given, cls, called.types, called.overloads
    )


def make_thread(machine: Machine, arguments: Arguments) -> Value:
    """Make a thread, which runs what it is given."""
    bound = bind(machine, None, arguments) if len(arguments.values) > 1 else arguments.get(0)
    machine.escape(bound)
    return Instance(_THREAD)


def make_function(_: Machine, arguments: Arguments) -> Value:
    """Make a std::function, which is what it holds."""
    return arguments.get(0) or Hole("function")


def end_program(_: Machine, __: object, ___: Arguments) -> Value:
    """End the program."""
    raise ThrownError("SystemExit")


def hidden(machine: Machine, _: object, arguments: Arguments) -> Value:
    """Note a call that runs what the source does not show."""
    what = " ".join(spelled(value) for value in arguments.values[:1])
    machine.recorder.unresolved(f"call of {what}", _HIDDEN, arguments.evidence)
    return Hole("hidden")


def system(machine: Machine, _: object, arguments: Arguments) -> Value:
    """Note what a command line starts: `system("roslaunch …")`."""
    for option in options(arguments.get(0)):
        started_by_words(machine, shell_words(spelled(option)), arguments)
    return Hole("system")


def getenv(machine: Machine, _: object, arguments: Arguments) -> Value:
    """Return an environment variable of the node."""
    name = arguments.get(0)
    environ = dict(machine.recorder.site.environ)
    if isinstance(name, Known):
        return Known(environ[str(name.value)]) if name.value in environ else NONE
    return Hole("getenv")


def make_pointer(_: Machine, arguments: Arguments) -> Value:
    """Make a smart pointer, which is what it points at."""
    return arguments.get(0) or NONE


def make_shared(machine: Machine, _: object, arguments: Arguments) -> Value:
    """Make the object: `std::make_shared<T>(…)`."""
    type = arguments.types[0] if arguments.types else TypeRef("?")
    return shared(machine, cpp(machine).make(type, arguments))


def shared(machine: Machine, made: Value) -> Value:
    """Remember that an object is held by pointers: in ROS 2, a list of them holds itself."""
    if isinstance(made, Instance) and machine.recorder.site.ros > 1:
        machine.shared.add(id(made))
    return made


_THREAD = NativeClass("boost::thread")

"""What C++ calls for others: bind, threads, other programs."""

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.cpp.held_values import construct_in_place
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine, ThrownError
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.language_runtime import cpp_runtime
from rtron.sources.code.ir import TypeRef
from rtron.sources.code.library_models.common.command_lines import record_started, shell_words

_HIDDEN_REASON = "runs or registers what the source does not show"


def bind(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`boost::bind(&C::method, object, _1)`: the method, bound to the object (boost: bind)."""
    called, given = arguments.get(0), arguments.values[1:]
    if not isinstance(called, av.FunctionValue):
        return av.Unknown("bind")
    if given and isinstance(given[0], av.Instance) and _is_method_of(machine, called, given[0]):
        return _bind_method(_overriding(machine, called, given[0]), given[0], given[1:])
    if called.owner is not None and given and given[0] is called.owner:
        given = given[1:]
    return av.FunctionValue(
        called.function,
        called.closure,
        called.owner,
        given,
        called.cls,
        called.types,
        called.overloads,
    )


def _is_method_of(machine: AbstractMachine, called: av.FunctionValue, owner: av.Instance) -> bool:
    """Tell whether the first argument is the object; `&C::f` within C has `this` already."""
    if "::" not in called.function.name or called.function.static:
        return False
    lineage = machine.runtime.lineage(owner.type)
    return called.owner is None or any(cls is called.cls for cls in lineage)


def _overriding(
    machine: AbstractMachine, called: av.FunctionValue, owner: av.Instance
) -> av.FunctionValue:
    """Return what an object's class has for a method that is pure virtual where it is named."""
    plain = called.function.name.rpartition("::")[2]
    found = machine.runtime.attribute(owner, plain, ()) if called.function.body is None else None
    return found if isinstance(found, av.FunctionValue) else called


def _bind_method(
    called: av.FunctionValue, owner: av.Instance, given: tuple[av.Value, ...]
) -> av.FunctionValue:
    cls = called.cls or (owner.type if not isinstance(owner.type, av.LibraryClass) else None)
    return av.FunctionValue(
        called.function, called.closure, owner, given, cls, called.types, called.overloads
    )


def make_thread(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """Make a thread, which runs what it is given."""
    bound = bind(machine, None, arguments) if len(arguments.values) > 1 else arguments.get(0)
    machine.escape(bound)
    return av.Instance(_THREAD)


def run_async(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`std::async([policy,] function, args…)`."""
    policy = (
        isinstance(arguments.get(0), (av.ExternalSymbol, av.Unknown)) and len(arguments.values) > 1
    )
    return make_thread(machine, arguments.without_first(1) if policy else arguments)


def make_function(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """Make a std::function, which is what it holds."""
    return arguments.get(0) or av.Unknown("function")


def exchange(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`std::exchange(variable, value)`: return what the variable held before."""
    slot = arguments.slot(0)
    if slot is not None:
        machine.undo_log.set(*slot, arguments.value(1))
    return arguments.value(0)


def swap(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`std::swap(a, b)`."""
    first, second = arguments.slot(0), arguments.slot(1)
    if first is not None and second is not None:
        machine.undo_log.set(*first, arguments.value(1))
        machine.undo_log.set(*second, arguments.value(0))
    return av.NONE


def end_program(_: AbstractMachine, __: object, ___: Arguments) -> av.Value:
    """End the program."""
    raise ThrownError("SystemExit")


def note_hidden_code(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """Note a call that runs what the source does not show."""
    what = " ".join(av.text_with_holes(value) for value in arguments.values[:1])
    machine.recorder.add_unresolved(f"call of {what}", _HIDDEN_REASON, arguments.evidence)
    return av.Unknown("hidden")


def run_system(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """Note what a command line starts: `system("roslaunch …")`."""
    for option in av.options(arguments.get(0)):
        record_started(machine, shell_words(av.text_with_holes(option)), arguments)
    return av.Unknown("system")


def getenv(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """Return an environment variable of the node."""
    name = arguments.get(0)
    environ = dict(machine.recorder.site.environ)
    if isinstance(name, av.Scalar):
        return av.Scalar(environ[str(name.value)]) if name.value in environ else av.NONE
    return av.Unknown("getenv")


def make_pointer(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """Make a smart pointer, which is what it points at."""
    return arguments.get(0) or av.NONE


def make_holder(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """Make a std::optional or the like, which is what it holds."""
    made = construct_in_place(machine, arguments)
    return make_pointer(machine, arguments) if made is None else made


def make_held(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`std::make_optional<T>(args…)`, `std::make_any<T>(args…)`."""
    if not arguments.types:
        return arguments.value(0)
    return cpp_runtime(machine).construct(arguments.types[0], arguments)


def make_shared(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """Make the object: `std::make_shared<T>(…)`."""
    type = arguments.types[0] if arguments.types else TypeRef("?")
    return hold_by_pointer(machine, cpp_runtime(machine).construct(type, arguments))


def hold_by_pointer(machine: AbstractMachine, made: av.Value) -> av.Value:
    """Remember that an object is held by pointers: in ROS 2, a list of them holds itself."""
    if isinstance(made, av.Instance) and machine.recorder.site.ros > 1:
        machine.pointer_held.add(id(made))
    return made


_THREAD = av.LibraryClass("boost::thread")

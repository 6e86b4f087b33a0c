"""What the arguments of a call into ROS's C++ libraries say: names, messages, callbacks."""

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.language_runtime import cpp_runtime
from rtron.sources.code.ir import TypeRef
from rtron.sources.code.library_models.ros1_common.names import resolve_name


def resolve_in_handle(machine: AbstractMachine, owner: av.Value, name: av.Value | None) -> av.Value:
    """Return a name resolved in a handle, before remapping."""
    namespace = owner.fields.get("namespace") if isinstance(owner, av.Instance) else None
    return resolve_name(machine, name if name is not None else av.UNKNOWN, namespace)


def name_arguments(arguments: Arguments) -> list[av.Value]:
    """Return the arguments that are, or may be, names."""
    return [
        value
        for value in arguments.values
        if any(not isinstance(o, (av.Instance, av.FunctionValue)) for o in av.options(value))
        and not (isinstance(value, av.Scalar) and not isinstance(value.value, str))
    ]


def template_message_type(machine: AbstractMachine, arguments: Arguments) -> str:
    """Return the message of the first template argument; empty where there is none."""
    return message_type_of(machine, next(iter(arguments.types), None), arguments)


def message_type_of(machine: AbstractMachine, type: TypeRef | None, arguments: Arguments) -> str:
    """Return a C++ type as a message type, typedefs and template parameters followed."""
    if type is None:
        return ""
    return cpp_runtime(machine).message_type(type, arguments.frame.scope, arguments.frame.types)


def callback_message_type(machine: AbstractMachine, arguments: Arguments, first: int) -> str:
    """Return the message that the first callback among the arguments takes."""
    for value in arguments.values[first:]:
        for option in av.options(value):
            if isinstance(option, av.FunctionValue):
                return _parameter_message_type(machine, option, arguments)
    return ""


def _parameter_message_type(
    machine: AbstractMachine, callback: av.FunctionValue, arguments: Arguments
) -> str:
    given = callback.bound_arguments
    indices = [at for at, value in enumerate(given) if isinstance(value, av.BindPlaceholder)]
    at = indices[0] if indices else len(given)
    for function in callback.overloads or (callback.function,):
        if at < len(function.params):
            scope = function.name.rpartition("::")[0]
            types = {
                **dict(arguments.frame.types),
                **cpp_runtime(machine).template_bindings(callback),
            }
            return cpp_runtime(machine).message_type(function.params[at].type, scope, types)
    return ""


def escape_functions(machine: AbstractMachine, arguments: Arguments) -> None:
    """Remember every function among the arguments; a method with its object."""
    owners = [value for value in arguments.values if isinstance(value, av.Instance)]
    for value in arguments.values:
        for option in av.options(value):
            machine.escape(_with_object(machine, option, owners), arguments.evidence)


def _with_object(machine: AbstractMachine, value: av.Value, owners: list[av.Instance]) -> av.Value:
    if isinstance(value, av.FunctionValue) and value.owner is None and owners:
        return cpp_runtime(machine).bind_method(value, owners[0])
    return value


def register_callbacks(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`registerCallback(…)` and the like; more are registered on what they return."""
    escape_functions(machine, arguments)
    return owner

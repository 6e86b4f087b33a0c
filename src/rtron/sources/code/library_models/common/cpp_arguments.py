"""What the arguments of a call into ROS's C++ libraries say: names, messages, callbacks."""

from rtron.sources.code.interpreter.abstract_values.value_types import (
    FunctionValue,
    Hole,
    Instance,
    Known,
    Placeholder,
    Value,
    options,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.ir import TypeRef
from rtron.sources.code.library_models.common.cpp import cpp
from rtron.sources.code.library_models.ros1_common.names import resolve

_UNKNOWN = Hole("?")


def in_handle(machine: Machine, owner: Value, name: Value | None) -> Value:
    """Return a name resolved in a handle, before remapping."""
    namespace = owner.fields.get("namespace") if isinstance(owner, Instance) else None
    return resolve(machine, name if name is not None else _UNKNOWN, namespace)


def texts(arguments: Arguments) -> list[Value]:
    """Return the arguments that are, or may be, names."""
    return [
        value
        for value in arguments.values
        if any(not isinstance(o, (Instance, FunctionValue)) for o in options(value))
        and not (isinstance(value, Known) and not isinstance(value.value, str))
    ]


def typed(machine: Machine, arguments: Arguments, at: int = 0) -> str:
    """Return the message of a template argument; empty where there is none."""
    if len(arguments.types) <= at:
        return ""
    return message_of(machine, arguments.types[at], arguments)


def message_of(machine: Machine, type: TypeRef | None, arguments: Arguments) -> str:
    """Return a C++ type as a message type, typedefs and template parameters followed."""
    if type is None:
        return ""
    return cpp(machine).message_in(type, arguments.frame.scope, arguments.frame.types)


def callback_message(machine: Machine, arguments: Arguments, first: int) -> str:
    """Return the message that the first callback among the arguments takes."""
    for value in arguments.values[first:]:
        for option in options(value):
            if isinstance(option, FunctionValue):
                return _message_taken(machine, option, arguments)
    return ""


def _message_taken(machine: Machine, callback: FunctionValue, arguments: Arguments) -> str:
    given = callback.given
    places = [at for at, value in enumerate(given) if isinstance(value, Placeholder)]
    at = places[0] if places else len(given)
    for function in callback.overloads or (callback.function,):
        if at < len(function.params):
            scope = function.name.rpartition("::")[0]
            types = {**dict(arguments.frame.types), **cpp(machine).types_of(callback)}
            return cpp(machine).message_in(function.params[at].type, scope, types)
    return ""


def escape_all(machine: Machine, arguments: Arguments) -> None:
    """Remember every function among the arguments; a method with its object."""
    owners = [value for value in arguments.values if isinstance(value, Instance)]
    for value in arguments.values:
        for option in options(value):
            machine.escape(_with_object(machine, option, owners))


def _with_object(machine: Machine, value: Value, owners: list[Instance]) -> Value:
    if isinstance(value, FunctionValue) and value.owner is None and owners:
        return cpp(machine).owned(value, owners[0])
    return value


def take_callbacks(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`registerCallback(…)` and its kin; more are registered on what they return."""
    escape_all(machine, arguments)
    return owner

"""The parameter server as roscpp reads and writes it (ROS wiki: roscpp/Overview)."""

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp_arguments import resolve_in_handle
from rtron.sources.code.library_models.ros1_common.names import parameter_value, search_parameter

_NAME_AND_DEFAULT = 2


def param(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`param("name", variable, default)`, `param<T>("name", default)`."""
    written = len(arguments.values) > _NAME_AND_DEFAULT
    default = arguments.get(2 if written else 1) or av.UNKNOWN
    found = _cpp_value(
        parameter_value(machine, resolve_in_handle(machine, owner, arguments.get(0)))
    )
    value = value_or_default(found, default)
    slot = arguments.slot(1)
    if not written:
        return value
    if slot is not None:
        machine.undo_log.set(*slot, value)
    return av.FALSE if found is None else av.TRUE


def _cpp_value(value: av.Value | None) -> av.Value | None:
    """Return a parameter as C++ holds it: a struct is a map, whose items are pairs."""
    if isinstance(value, av.MapValue):
        inner = {key: _cpp_value(entry) or av.NONE for key, entry in value.fields.items()}
        return av.MapValue(inner, iterates_pairs=True)
    if isinstance(value, av.ListValue):
        return av.list_of([_cpp_value(item) or av.NONE for item in value.items])
    return value


def value_or_default(found: av.Value | None, default: av.Value) -> av.Value:
    """Return a parameter's value, the default where it is not set, both where that is unknown."""
    if found is None:
        return _tainted(default)
    return av.join((_tainted(default), found)) if isinstance(found, av.Unknown) else found


def _tainted(value: av.Value) -> av.Value:
    return av.Scalar(value.value, tainted=True) if isinstance(value, av.Scalar) else value


def get_param(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`getParam("name", variable)`: whether it is set; the variable stays where it is not."""
    found = _cpp_value(
        parameter_value(machine, resolve_in_handle(machine, owner, arguments.get(0)))
    )
    slot = arguments.slot(1)
    if found is None:
        return av.FALSE
    if slot is not None:
        before = slot.holder.get(slot.key)
        keeps_default = (
            isinstance(found, av.Unknown) and isinstance(before, av.Scalar) and bool(before.value)
        )
        machine.undo_log.set(
            *slot, _tainted(before) if keeps_default and before is not None else found
        )
    return av.Unknown("getParam") if isinstance(found, av.Unknown) else av.TRUE


def has_param(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`hasParam("name")`."""
    found = parameter_value(machine, resolve_in_handle(machine, owner, arguments.get(0)))
    return (
        av.FALSE
        if found is None
        else av.Unknown("hasParam")
        if isinstance(found, av.Unknown)
        else av.TRUE
    )


def set_param(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`setParam("name", value)`."""
    name = resolve_in_handle(machine, owner, arguments.get(0))
    if isinstance(name, av.Scalar):
        machine.undo_log.set(machine.parameters, str(name.value), arguments.value(1))
    return av.Unknown("setParam")


def search_param(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`searchParam("name", found)` (ROS wiki: Parameter Server)."""
    namespace = resolve_in_handle(machine, owner, av.Scalar(""))
    found = search_parameter(machine, arguments.value(0), namespace)
    slot = arguments.slot(1)
    if found is None:
        return av.FALSE
    if slot is not None:
        machine.undo_log.set(*slot, found)
    return av.Unknown("searchParam") if isinstance(found, av.Unknown) else av.TRUE

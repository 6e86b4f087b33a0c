"""The parameter server as roscpp reads and writes it (ROS wiki: roscpp/Overview)."""

from rtron.sources.code.interpreter.abstract_values.items import list_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    NONE,
    TRUE,
    UNKNOWN,
    ListValue,
    MapValue,
    Scalar,
    Unknown,
    Value,
    join,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp_arguments import resolve_in_handle
from rtron.sources.code.library_models.ros1_common.names import parameter_value, search_parameter

_NAME_AND_DEFAULT = 2


def param(machine: AbstractMachine, owner: Value, arguments: Arguments) -> Value:
    """`param("name", variable, default)`, `param<T>("name", default)`."""
    written = len(arguments.values) > _NAME_AND_DEFAULT
    default = arguments.get(2 if written else 1) or UNKNOWN
    found = _cpp_value(
        parameter_value(machine, resolve_in_handle(machine, owner, arguments.get(0)))
    )
    value = value_or_default(found, default)
    slot = arguments.slot(1)
    if not written:
        return value
    if slot is not None:
        machine.undo_log.set(*slot, value)
    return FALSE if found is None else TRUE


def _cpp_value(value: Value | None) -> Value | None:
    """Return a parameter as C++ holds it: a struct is a map, whose items are pairs."""
    if isinstance(value, MapValue):
        inner = {key: _cpp_value(entry) or NONE for key, entry in value.fields.items()}
        return MapValue(inner, iterates_pairs=True)
    if isinstance(value, ListValue):
        return list_of([_cpp_value(item) or NONE for item in value.items])
    return value


def value_or_default(found: Value | None, default: Value) -> Value:
    """Return a parameter's value, the default where it is not set, both where that is unknown."""
    if found is None:
        return _tainted(default)
    return join((_tainted(default), found)) if isinstance(found, Unknown) else found


def _tainted(value: Value) -> Value:
    return Scalar(value.value, tainted=True) if isinstance(value, Scalar) else value


def get_param(machine: AbstractMachine, owner: Value, arguments: Arguments) -> Value:
    """`getParam("name", variable)`: whether it is set; the variable stays where it is not."""
    found = _cpp_value(
        parameter_value(machine, resolve_in_handle(machine, owner, arguments.get(0)))
    )
    slot = arguments.slot(1)
    if found is None:
        return FALSE
    if slot is not None:
        before = slot.holder.get(slot.key)
        keeps_default = (
            isinstance(found, Unknown) and isinstance(before, Scalar) and bool(before.value)
        )
        machine.undo_log.set(
            *slot, _tainted(before) if keeps_default and before is not None else found
        )
    return Unknown("getParam") if isinstance(found, Unknown) else TRUE


def has_param(machine: AbstractMachine, owner: Value, arguments: Arguments) -> Value:
    """`hasParam("name")`."""
    found = parameter_value(machine, resolve_in_handle(machine, owner, arguments.get(0)))
    return FALSE if found is None else Unknown("hasParam") if isinstance(found, Unknown) else TRUE


def set_param(machine: AbstractMachine, owner: Value, arguments: Arguments) -> Value:
    """`setParam("name", value)`."""
    name = resolve_in_handle(machine, owner, arguments.get(0))
    if isinstance(name, Scalar):
        machine.undo_log.set(machine.parameters, str(name.value), arguments.value(1))
    return Unknown("setParam")


def search_param(machine: AbstractMachine, owner: Value, arguments: Arguments) -> Value:
    """`searchParam("name", found)` (ROS wiki: Parameter Server)."""
    namespace = resolve_in_handle(machine, owner, Scalar(""))
    found = search_parameter(machine, arguments.value(0), namespace)
    slot = arguments.slot(1)
    if found is None:
        return FALSE
    if slot is not None:
        machine.undo_log.set(*slot, found)
    return Unknown("searchParam") if isinstance(found, Unknown) else TRUE

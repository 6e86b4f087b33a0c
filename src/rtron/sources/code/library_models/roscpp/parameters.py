"""The parameter server as roscpp reads and writes it (ROS wiki: roscpp/Overview)."""

from rtron.sources.code.interpreter.abstract_values.items import listed
from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    NONE,
    TRUE,
    Hole,
    Known,
    ListValue,
    MapValue,
    Value,
    join,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp_arguments import in_handle
from rtron.sources.code.library_models.ros1_common.names import parameter, search

_UNKNOWN = Hole("?")
_NAME_AND_DEFAULT = 2


def param(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`param("name", variable, default)`, `param<T>("name", default)`."""
    written = len(arguments.values) > _NAME_AND_DEFAULT
    default = arguments.get(2 if written else 1) or _UNKNOWN
    found = _of_cpp(parameter(machine, in_handle(machine, owner, arguments.get(0))))
    value = or_default(found, default)
    place = arguments.place(1)
    if not written:
        return value
    if place is not None:
        machine.trail.set(*place, value)
    return FALSE if found is None else TRUE


def _of_cpp(value: Value | None) -> Value | None:
    """Return a parameter as C++ holds it: a struct is a map, whose items are pairs."""
    if isinstance(value, MapValue):
        inner = {key: _of_cpp(entry) or NONE for key, entry in value.fields.items()}
        return MapValue(inner, pairs=True)
    if isinstance(value, ListValue):
        return listed([_of_cpp(item) or NONE for item in value.items])
    return value


def or_default(found: Value | None, default: Value) -> Value:
    """Return a parameter's value, the default where it is not set, both where nobody knows."""
    if found is None:
        return _as_parameter(default)
    return join((_as_parameter(default), found)) if isinstance(found, Hole) else found


def _as_parameter(value: Value) -> Value:
    return Known(value.value, tainted=True) if isinstance(value, Known) else value


def get_param(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`getParam("name", variable)`: whether it is set; the variable stays where it is not."""
    found = _of_cpp(parameter(machine, in_handle(machine, owner, arguments.get(0))))
    place = arguments.place(1)
    if found is None:
        return FALSE
    if place is not None:
        before = place.holder.get(place.key)
        kept = isinstance(found, Hole) and isinstance(before, Known) and bool(before.value)
        machine.trail.set(*place, _as_parameter(before) if kept and before is not None else found)
    return Hole("getParam") if isinstance(found, Hole) else TRUE


def has_param(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`hasParam("name")`."""
    found = parameter(machine, in_handle(machine, owner, arguments.get(0)))
    return FALSE if found is None else Hole("hasParam") if isinstance(found, Hole) else TRUE


def set_param(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`setParam("name", value)`."""
    name = in_handle(machine, owner, arguments.get(0))
    if isinstance(name, Known):
        machine.trail.set(machine.parameters, str(name.value), arguments.get(1) or _UNKNOWN)
    return Hole("setParam")


def search_param(machine: Machine, owner: Value, arguments: Arguments) -> Value:
    """`searchParam("name", found)` (ROS wiki: Parameter Server)."""
    namespace = in_handle(machine, owner, Known(""))
    found = search(machine, arguments.get(0) or _UNKNOWN, namespace)
    place = arguments.place(1)
    if found is None:
        return FALSE
    if place is not None:
        machine.trail.set(*place, found)
    return Hole("searchParam") if isinstance(found, Hole) else TRUE

"""Python's dataclasses: `__init__` takes the fields in order."""

from collections.abc import Mapping

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    ClassValue,
    FunctionValue,
    Hole,
    Instance,
    Native,
    NativeClass,
    Value,
    spelled,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch

_DATACLASS = NativeClass("dataclass")


def _decorate(_: Machine, __: object, arguments: Arguments) -> Value:
    """`@dataclass`, or `@dataclass(frozen=True)`, which returns the decorator."""
    cls = arguments.get(0)
    if cls is None:
        return Native("dataclass", _decorate)
    if isinstance(cls, ClassValue):
        cls.fields.setdefault("__init__", Native("__init__", _init, _DATACLASS))
    return cls


def _init(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    for place, (name, default) in enumerate(_fields(machine, owner)):
        value = arguments.get(place, name) or default or Hole(name)
        machine.trail.set(owner.fields, name, value)
    return NONE


def _fields(machine: Machine, owner: Instance) -> list[tuple[str, Value | None]]:
    """Return the fields of a class and its bases: those without a default come first."""
    found: dict[str, Value | None] = {}
    classes = [cls for cls in machine.world.lineage(owner.type) if isinstance(cls, ClassValue)]
    for cls in reversed(classes):
        bare = items_of(cls.fields.get("__fields__", NONE))[0]
        found.update({spelled(name): None for name in bare})
        own = {n: v for n, v in cls.fields.items() if _is_field(n, v)}
        found.update(own)
    return list(found.items())


def _is_field(name: str, value: Value) -> bool:
    return not name.startswith("__") and not isinstance(value, (FunctionValue, ClassValue))


def _field(machine: Machine, _: object, arguments: Arguments) -> Value:
    factory = arguments.keywords.get("default_factory")
    if factory is not None:
        return dispatch(machine, factory, Arguments(line=arguments.line, frame=arguments.frame))
    return arguments.keywords.get("default", Hole("field"))


DATACLASSES: Mapping[str, Value] = {
    "dataclasses.dataclass": Native("dataclass", _decorate),
    "dataclasses.field": Native("field", _field),
}

"""Python's dataclasses: `__init__` takes the fields in order."""

from collections.abc import Mapping

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    ClassValue,
    FunctionValue,
    Instance,
    LibraryClass,
    LibraryFunction,
    Unknown,
    Value,
    text_with_holes,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch

_DATACLASS = LibraryClass("dataclass")


def _decorate_class(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`@dataclass`, or `@dataclass(frozen=True)`, which returns the decorator."""
    cls = arguments.get(0)
    if cls is None:
        return LibraryFunction("dataclass", _decorate_class)
    if isinstance(cls, ClassValue):
        cls.fields.setdefault("__init__", LibraryFunction("__init__", _initialise, _DATACLASS))
    return cls


def _initialise(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    for index, (name, default) in enumerate(_dataclass_fields(machine, owner)):
        value = arguments.get(index, name) or default or Unknown(name)
        machine.undo_log.set(owner.fields, name, value)
    return NONE


def _dataclass_fields(machine: AbstractMachine, owner: Instance) -> list[tuple[str, Value | None]]:
    """Return the fields of a class and its bases: those without a default come first."""
    found: dict[str, Value | None] = {}
    classes = [cls for cls in machine.runtime.lineage(owner.type) if isinstance(cls, ClassValue)]
    for cls in reversed(classes):
        bare = items_of(cls.fields.get("__fields__", NONE))[0]
        found.update({text_with_holes(name): None for name in bare})
        own = {n: v for n, v in cls.fields.items() if _is_field(n, v)}
        found.update(own)
    return list(found.items())


def _is_field(name: str, value: Value) -> bool:
    return not name.startswith("__") and not isinstance(value, (FunctionValue, ClassValue))


def _make_field(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    factory = arguments.keywords.get("default_factory")
    if factory is not None:
        return dispatch(machine, factory, Arguments(line=arguments.line, frame=arguments.frame))
    return arguments.keywords.get("default", Unknown("field"))


DATACLASSES: Mapping[str, Value] = {
    "dataclasses.dataclass": LibraryFunction("dataclass", _decorate_class),
    "dataclasses.field": LibraryFunction("field", _make_field),
}

"""Python's enumerations: members are objects of their class, with a name and a value."""

from collections.abc import Mapping

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    ClassValue,
    FunctionValue,
    Instance,
    LibraryClass,
    LibraryFunction,
    ListValue,
    MapValue,
    Scalar,
    Unknown,
    Value,
    text_with_holes,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.ir import Class


def add_enum_members(cls: ClassValue) -> ClassValue:
    """Make the plain values in an enumeration's body its members."""
    for name, value in cls.fields.items():
        if not name.startswith("_") and not isinstance(value, (FunctionValue, Instance)):
            cls.fields[name] = Instance(cls, {"name": Scalar(name), "value": value})
    return cls


def enum_member(cls: ClassValue, value: Value) -> Value:
    """Return what `Class(value)` is: the member of that value."""
    for found in items_of(cls)[0]:
        if isinstance(found, Instance) and found.fields["value"] == value:
            return found
    return Unknown(cls.name)


def _make_enum(_: AbstractMachine, arguments: Arguments) -> Value:
    """`Enum("Name", "LEFT RIGHT")`, `Enum("Name", ["LEFT", "RIGHT"])` or with a dict."""
    name = text_with_holes(arguments.get(0) or Unknown("Enum"))
    definition = Class(name=name, file=arguments.frame.file, line=arguments.line)
    fields = _enum_values(arguments.value(1, "names"))
    return add_enum_members(ClassValue(definition, (ENUM,), fields))


def _enum_values(names: Value) -> dict[str, Value]:
    if isinstance(names, MapValue):
        return {str(key): value for key, value in names.entries.items()}
    if isinstance(names, ListValue):
        words = [text_with_holes(item) for item in names.items]
    else:
        words = text_with_holes(names).replace(",", " ").split()
    return {word: Scalar(number) for number, word in enumerate(words, start=1)}


ENUM = LibraryClass("enum.Enum", _make_enum)

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
        return dispatch(machine, factory, arguments.with_values())
    return arguments.keywords.get("default", Unknown("field"))


DATACLASSES: Mapping[str, Value] = {
    "dataclasses.dataclass": LibraryFunction("dataclass", _decorate_class),
    "dataclasses.field": LibraryFunction("field", _make_field),
}

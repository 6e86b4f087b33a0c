"""Python's enumerations: members are objects of their class, with a name and a value."""

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    ClassValue,
    FunctionValue,
    Instance,
    LibraryClass,
    ListValue,
    MapValue,
    Scalar,
    Unknown,
    Value,
    text_with_holes,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
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
    fields = _enum_values(arguments.get(1, "names") or Unknown("?"))
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

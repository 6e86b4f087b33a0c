"""Python's enumerations: members are objects of their class, with a name and a value."""

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    ClassValue,
    FunctionValue,
    Hole,
    Instance,
    Known,
    ListValue,
    MapValue,
    NativeClass,
    Value,
    spelled,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.ir import Class


def with_members(cls: ClassValue) -> ClassValue:
    """Make the plain values in an enumeration's body its members."""
    for name, value in cls.fields.items():
        if not name.startswith("_") and not isinstance(value, (FunctionValue, Instance)):
            cls.fields[name] = Instance(cls, {"name": Known(name), "value": value})
    return cls


def member(cls: ClassValue, value: Value) -> Value:
    """Return what `Class(value)` is: the member of that value."""
    for found in items_of(cls)[0]:
        if isinstance(found, Instance) and found.fields["value"] == value:
            return found
    return Hole(cls.name)


def _make(_: Machine, arguments: Arguments) -> Value:
    """`Enum("Name", "LEFT RIGHT")`, `Enum("Name", ["LEFT", "RIGHT"])` or with a dict."""
    name = spelled(arguments.get(0) or Hole("Enum"))
    definition = Class(name=name, file=arguments.frame.file, line=arguments.line)
    fields = _members(arguments.get(1, "names") or Hole("?"))
    return with_members(ClassValue(definition, (ENUM,), fields))


def _members(names: Value) -> dict[str, Value]:
    if isinstance(names, MapValue):
        return {str(key): value for key, value in names.entries.items()}
    if isinstance(names, ListValue):
        words = [spelled(item) for item in names.items]
    else:
        words = spelled(names).replace(",", " ").split()
    return {word: Known(place) for place, word in enumerate(words, start=1)}


ENUM = NativeClass("enum.Enum", _make)

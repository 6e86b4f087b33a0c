"""Python's enumerations: members are objects of their class, with a name and a value."""

from collections.abc import Mapping

from rtron.sources.code.interpreter.abstract_values.items import items_of, list_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    FALSE,
    NONE,
    ClassValue,
    ExternalSymbol,
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
from rtron.sources.code.interpreter.execution.arguments import OPEN_KEYWORD, Arguments
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

NAMED_TUPLE = ExternalSymbol("typing.NamedTuple")
_DATACLASS = LibraryClass("dataclass")
_FIELD = LibraryClass("dataclasses.Field")


def _decorate_class(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`@dataclass`, or `@dataclass(frozen=True)`, which returns the decorator."""
    cls = arguments.get(0)
    if cls is None:
        return LibraryFunction("dataclass", _decorate_class)
    if isinstance(cls, ClassValue):
        cls.fields.setdefault("__fields__", list_of((), "tuple"))
        add_initialiser(cls)
    return cls


def add_initialiser(cls: ClassValue) -> None:
    """Give a dataclass or NamedTuple its `__init__`."""
    cls.fields.setdefault("__init__", LibraryFunction("__init__", _initialise, _DATACLASS))


def _initialise(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    index = 0
    for name, default in _dataclass_fields(machine, owner):
        is_given = not (is_field(default) and default.fields.get("init") == FALSE)  # type: ignore[union-attr]
        given = arguments.get(index, name) if is_given else None
        index += is_given
        value = given or _default_value(machine, default, arguments) or Unknown(name)
        machine.undo_log.set(owner.fields, name, value)
    finish = machine.runtime.attribute(owner, "__post_init__", ())
    if finish is not None:
        dispatch(machine, finish, arguments.with_values())
    return NONE


def is_field(value: Value | None) -> bool:
    """Tell whether a default is what `field(…)` returns."""
    return isinstance(value, Instance) and value.type is _FIELD


def _default_value(machine: AbstractMachine, default: Value | None, at: Arguments) -> Value | None:
    """Return a field's default, which a factory makes anew for each object."""
    if OPEN_KEYWORD in at.keywords:
        return None
    if not is_field(default):
        return default
    factory = default.fields.get("default_factory")  # type: ignore[union-attr]
    if factory is not None:
        return dispatch(machine, factory, at.with_values())
    return default.fields.get("default")  # type: ignore[union-attr]


def _dataclass_fields(machine: AbstractMachine, owner: Instance) -> list[tuple[str, Value | None]]:
    """Return the fields of a class and its bases, each with its default."""
    found: dict[str, Value | None] = {}
    classes = [cls for cls in machine.runtime.lineage(owner.type) if isinstance(cls, ClassValue)]
    for cls in reversed(classes):
        for item in items_of(cls.fields.get("__fields__", NONE))[0]:
            name = text_with_holes(item)
            found[name] = cls.fields.get(name)
    return list(found.items())


def _make_field(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    return Instance(_FIELD, dict(arguments.keywords))


def iterate_fields(machine: AbstractMachine, owner: Instance) -> tuple[Value, ...]:
    """Return the items of a NamedTuple."""
    names = [name for name, _ in _dataclass_fields(machine, owner)]
    return tuple(owner.fields.get(name, Unknown(name)) for name in names)


def _replace(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`replace(object, **changes)`."""
    owner = arguments.get(0)
    if not isinstance(owner, Instance):
        return Unknown("replace")
    made = Instance(owner.type, dict(owner.fields))
    for name, value in arguments.keywords.items():
        machine.undo_log.set(made.fields, name, value)
    return made


def _as_dict(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    owner = arguments.get(0)
    return MapValue(dict(owner.fields)) if isinstance(owner, Instance) else Unknown("asdict")


DATACLASSES: Mapping[str, Value] = {
    "dataclasses.replace": LibraryFunction("replace", _replace),
    "dataclasses.asdict": LibraryFunction("asdict", _as_dict),
    "dataclasses.dataclass": LibraryFunction("dataclass", _decorate_class),
    "dataclasses.field": LibraryFunction("field", _make_field),
}

"""Python's enumerations, data classes and named tuples, made from their fields."""

from collections.abc import Mapping

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import OPEN_KEYWORD, Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch


def add_enum_members(cls: av.ClassValue) -> av.ClassValue:
    """Make the plain values in an enumeration's body its members."""
    for name, value in cls.fields.items():
        if not name.startswith("_") and not isinstance(value, (av.FunctionValue, av.Instance)):
            cls.fields[name] = av.Instance(cls, {"name": av.Scalar(name), "value": value})
    return cls


def enum_member(cls: av.ClassValue, value: av.Value) -> av.Value:
    """Return what `Class(value)` is: the member of that value."""
    for found in av.items_of(cls)[0]:
        if isinstance(found, av.Instance) and found.fields["value"] == value:
            return found
    return av.Unknown(cls.name)


ENUM = av.LibraryClass("enum.Enum")

NAMED_TUPLE = av.ExternalSymbol("typing.NamedTuple")
_DATACLASS = av.LibraryClass("dataclass")
_FIELD = av.LibraryClass("dataclasses.Field")


def _decorate_class(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`@dataclass`, or `@dataclass(frozen=True)`, which returns the decorator."""
    cls = arguments.get(0)
    if cls is None:
        return av.LibraryFunction("dataclass", _decorate_class)
    if isinstance(cls, av.ClassValue):
        cls.fields.setdefault("__fields__", av.list_of((), "tuple"))
        add_initialiser(cls)
    return cls


def add_initialiser(cls: av.ClassValue) -> None:
    """Give a dataclass or NamedTuple its `__init__`."""
    cls.fields.setdefault("__init__", av.LibraryFunction("__init__", _initialise, _DATACLASS))


def _initialise(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    index = 0
    for name, default in _fields(machine, owner):
        is_given = not (is_field(default) and default.fields.get("init") == av.FALSE)  # type: ignore[union-attr]
        given = arguments.get(index, name) if is_given else None
        index += is_given
        value = given or _default(machine, default, arguments) or av.Unknown(name)
        machine.undo_log.set(owner.fields, name, value)
    finish = machine.runtime.attribute(owner, "__post_init__", ())
    if finish is not None:
        dispatch(machine, finish, arguments.with_values())
    return av.NONE


def is_field(value: av.Value | None) -> bool:
    """Tell whether a default is what `field(…)` returns."""
    return isinstance(value, av.Instance) and value.type is _FIELD


def _default(machine: AbstractMachine, default: av.Value | None, at: Arguments) -> av.Value | None:
    """Return a field's default, which a factory makes anew for each object."""
    if OPEN_KEYWORD in at.keywords:
        return None
    if not is_field(default):
        return default
    factory = default.fields.get("default_factory")  # type: ignore[union-attr]
    if factory is not None:
        return dispatch(machine, factory, at.with_values())
    return default.fields.get("default")  # type: ignore[union-attr]


def _fields(machine: AbstractMachine, owner: av.Instance) -> list[tuple[str, av.Value | None]]:
    """Return the fields of a class and its bases, each with its default."""
    found: dict[str, av.Value | None] = {}
    classes = [cls for cls in machine.runtime.lineage(owner.type) if isinstance(cls, av.ClassValue)]
    for cls in reversed(classes):
        for item in av.items_of(cls.fields.get("__fields__", av.NONE))[0]:
            name = av.text_with_holes(item)
            found[name] = cls.fields.get(name)
    return list(found.items())


def iterate_fields(machine: AbstractMachine, owner: av.Instance) -> tuple[av.Value, ...]:
    """Return the items of a NamedTuple."""
    names = [name for name, _ in _fields(machine, owner)]
    return tuple(owner.fields.get(name, av.Unknown(name)) for name in names)


DATACLASSES: Mapping[str, av.Value] = {
    "dataclasses.dataclass": av.LibraryFunction("dataclass", _decorate_class),
    "dataclasses.field": av.LibraryFunction(
        "field", lambda _, __, arguments: av.Instance(_FIELD, dict(arguments.keywords))
    ),
}

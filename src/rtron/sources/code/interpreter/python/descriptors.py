"""What stands between a class and its members: properties, static methods, and `object`'s own."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    ClassValue,
    Instance,
    LibraryClass,
    LibraryFunction,
    Scalar,
    Unknown,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch


def _with_setter(_: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    return Instance(PROPERTY, {**owner.fields, "setter": arguments.get(0) or NONE})


def _with_getter(_: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    return Instance(PROPERTY, {**owner.fields, "getter": arguments.get(0) or NONE})


def _with_deleter(_: AbstractMachine, owner: Instance, __: Arguments) -> Value:
    return owner


PROPERTY = LibraryClass(
    "property", methods={"setter": _with_setter, "getter": _with_getter, "deleter": _with_deleter}
)


def _call_static(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    return dispatch(machine, owner.fields["getter"], arguments)


STATIC_METHOD = LibraryClass("staticmethod", methods={"__call__": _call_static})
CLASS_METHOD = LibraryClass("classmethod")
DESCRIPTORS = {
    "property": PROPERTY,
    "functools.cached_property": PROPERTY,
    "abc.abstractproperty": PROPERTY,
    "staticmethod": STATIC_METHOD,
    "classmethod": CLASS_METHOD,
}


def _describe(cls: LibraryClass, _: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`@property`, `property(getter, setter)`, `staticmethod(function)` and the like."""
    fields = {"getter": arguments.get(0, "fget") or NONE}
    setter = arguments.get(1, "fset")
    return Instance(cls, fields if setter is None else {**fields, "setter": setter})


DESCRIPTOR_FUNCTIONS: Mapping[str, Value] = {
    name: LibraryFunction(name, partial(_describe, cls)) for name, cls in DESCRIPTORS.items()
}


def _make_plain(_: AbstractMachine, __: Value, arguments: Arguments) -> Value:
    """`object.__new__(cls)`."""
    cls = arguments.get(0)
    return Instance(cls) if isinstance(cls, ClassValue) else Unknown("object")


def _set_plain(machine: AbstractMachine, owner: Value, arguments: Arguments) -> Value:
    """`object.__setattr__(self, name, value)`, which calls no other."""
    name = arguments.get(0)
    if isinstance(owner, (Instance, ClassValue)) and isinstance(name, Scalar):
        machine.undo_log.set(owner.fields, str(name.value), arguments.get(1) or NONE)
    return NONE


def _do_nothing(_: AbstractMachine, __: Value, ___: Arguments) -> Value:
    return NONE


OBJECT_METHODS: Mapping[str, Callable[..., Value]] = {
    "__new__": _make_plain,
    "__setattr__": _set_plain,
    **dict.fromkeys(("__init__", "__init_subclass__", "__del__"), _do_nothing),
}
"""The methods that every class has (docs.python.org: reference/datamodel)."""

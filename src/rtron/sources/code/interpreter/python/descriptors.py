"""What stands between a class and its members: properties, static methods, and `object`'s own."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch


def _with_setter(_: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    return av.Instance(PROPERTY, {**owner.fields, "setter": arguments.get(0) or av.NONE})


def _with_getter(_: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    return av.Instance(PROPERTY, {**owner.fields, "getter": arguments.get(0) or av.NONE})


def _with_deleter(_: AbstractMachine, owner: av.Instance, __: Arguments) -> av.Value:
    return owner


PROPERTY = av.LibraryClass(
    "property", methods={"setter": _with_setter, "getter": _with_getter, "deleter": _with_deleter}
)


def _call_static(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    return dispatch(machine, owner.fields["getter"], arguments)


STATIC_METHOD = av.LibraryClass("staticmethod", methods={"__call__": _call_static})
CLASS_METHOD = av.LibraryClass("classmethod")
DESCRIPTORS = {
    "property": PROPERTY,
    "functools.cached_property": PROPERTY,
    "abc.abstractproperty": PROPERTY,
    "staticmethod": STATIC_METHOD,
    "classmethod": CLASS_METHOD,
}


def _describe(
    cls: av.LibraryClass, _: AbstractMachine, __: object, arguments: Arguments
) -> av.Value:
    """`@property`, `property(getter, setter)`, `staticmethod(function)` and the like."""
    fields = {"getter": arguments.get(0, "fget") or av.NONE}
    setter = arguments.get(1, "fset")
    return av.Instance(cls, fields if setter is None else {**fields, "setter": setter})


DESCRIPTOR_FUNCTIONS: Mapping[str, av.Value] = {
    name: av.LibraryFunction(name, partial(_describe, cls)) for name, cls in DESCRIPTORS.items()
}


def _make_plain(_: AbstractMachine, __: av.Value, arguments: Arguments) -> av.Value:
    """`object.__new__(cls)`."""
    cls = arguments.get(0)
    return av.Instance(cls) if isinstance(cls, av.ClassValue) else av.Unknown("object")


def _set_plain(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`object.__setattr__(self, name, value)`, which calls no other."""
    name = arguments.get(0)
    if isinstance(owner, (av.Instance, av.ClassValue)) and isinstance(name, av.Scalar):
        machine.undo_log.set(owner.fields, str(name.value), arguments.get(1) or av.NONE)
    return av.NONE


def _do_nothing(_: AbstractMachine, __: av.Value, ___: Arguments) -> av.Value:
    return av.NONE


OBJECT_METHODS: Mapping[str, Callable[..., av.Value]] = {
    "__new__": _make_plain,
    "__setattr__": _set_plain,
    **dict.fromkeys(("__init__", "__init_subclass__", "__del__"), _do_nothing),
}
"""The methods that every class has (docs.python.org: reference/datamodel)."""

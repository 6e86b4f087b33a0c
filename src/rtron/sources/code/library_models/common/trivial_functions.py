"""Functions of libraries that give back what they get, or what only a run knows."""

from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments, LibraryCall


def return_owner(_: AbstractMachine, owner: av.Value, __: Arguments) -> av.Value:
    """Return the object that a method is called on."""
    return owner


def return_argument(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """Return the first argument: `std::move(x)`, `std::ref(x)`."""
    return arguments.get(0) or av.NONE


def return_none(_: AbstractMachine, __: object, ___: Arguments) -> av.Value:
    """Return nothing."""
    return av.NONE


def returning_unknown(label: str) -> LibraryCall:
    """Return a function whose result only a run knows: `rclcpp::ok()`."""
    return partial(_return_unknown, label)


def _return_unknown(label: str, _: AbstractMachine, __: object, ___: Arguments) -> av.Value:
    return av.Unknown(label)


def returning_field(name: str, default: av.Value = av.UNKNOWN) -> LibraryCall:
    """Return a method that gives a field of its object."""
    return lambda _machine, owner, _arguments: owner.fields.get(name, default)


def making(cls: av.LibraryClass) -> LibraryCall:
    """Return a function that makes an object of a class, whatever it is given."""
    return lambda _machine, _owner, _arguments: av.Instance(cls)

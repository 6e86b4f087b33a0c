"""Functions of libraries that give back what they get, or what only a run knows."""

from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import NONE, Unknown, Value
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments, LibraryCall


def return_owner(_: AbstractMachine, owner: Value, __: Arguments) -> Value:
    """Return the object that a method is called on."""
    return owner


def return_argument(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """Return the first argument: `std::move(x)`, `std::ref(x)`."""
    return arguments.get(0) or NONE


def return_none(_: AbstractMachine, __: object, ___: Arguments) -> Value:
    """Return nothing."""
    return NONE


def returning_unknown(label: str) -> LibraryCall:
    """Return a function whose result only a run knows: `rclcpp::ok()`."""
    return partial(_return_unknown, label)


def _return_unknown(label: str, _: AbstractMachine, __: object, ___: Arguments) -> Value:
    return Unknown(label)

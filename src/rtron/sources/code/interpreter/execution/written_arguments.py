"""What code that is not here may write to: what it gets by reference or by its address."""

from typing import Any

from rtron.sources.code.interpreter.abstract_values.truth import truth
from rtron.sources.code.interpreter.abstract_values.value_types import (
    OPEN,
    UNKNOWN,
    ClassValue,
    Instance,
    ListValue,
    MapValue,
    PartialText,
    Scalar,
    Unknown,
    Value,
    is_tainted,
    is_text,
    join,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments

MUTATING_FUNCTIONS = frozenset(
    {"replace", "transform", "reverse", "rotate", "swap", "generate", "fill", "sort", "strcat"}
)
"""Functions of the standard library that change what they are given."""
READ_ONLY_FUNCTIONS = frozenset(
    [
        *("printf", "fprintf", "puts", "fputs", "perror", "syslog", "strlen", "strncmp", "strstr"),
        *("stol", "stoll", "stoul", "stoull", "stof", "strtol", "strtoul", "strtod"),
        *("fopen", "open", "access", "stat", "opendir", "mkdir", "unlink", "setenv"),
    ]
)
"""Functions of the C and C++ libraries that leave the texts as they are which they are given."""


def forget_written(machine: AbstractMachine, name: str, arguments: Arguments) -> None:
    """Forget what an unknown function of C++ may have changed of what it gets."""
    _forget_written_strings(machine, name, arguments)
    _open_empty_containers(machine, arguments)
    forget_pointees(machine, arguments)


def forget_pointees(machine: AbstractMachine, arguments: Arguments) -> None:
    """Let a function write the numbers of what it gets by address, `&x` or a C array."""
    for position in arguments.addresses:
        slot = arguments.slot(position)
        if slot is not None:
            _forget_variable(machine, slot.holder, slot.key)
    for value in arguments.values if machine.runtime.passes_by_reference else ():
        if isinstance(value, ListValue):
            _forget_array(machine, value)


def _forget_variable(machine: AbstractMachine, holder: dict[Any, Value], key: Any) -> None:  # noqa: ANN401
    """Let a variable hold anything beside what it holds; of an object, each member of its own."""
    value = holder.get(key)
    if isinstance(value, Scalar) and not is_text(value):
        machine.undo_log.set(holder, key, _or_unknown(value))
    elif isinstance(value, ListValue):
        _forget_array(machine, value)
    elif isinstance(value, Instance) and isinstance(value.type, ClassValue):
        for name, member in list(value.fields.items()):
            if isinstance(member, Scalar) and not is_text(member):
                machine.undo_log.set(value.fields, name, _or_unknown(member))


def _forget_array(machine: AbstractMachine, array: ListValue) -> None:
    if array.type is not None and array.type.name == "std::array":
        machine.undo_log.set(array.fields, "items", tuple(map(_or_unknown, array.items)))


def _or_unknown(value: Value) -> Value:
    is_number = isinstance(value, Scalar) and not is_text(value)
    return join((value, Unknown("written", is_tainted(value)))) if is_number else value


def _open_empty_containers(machine: AbstractMachine, arguments: Arguments) -> None:
    """Leave open what is in a C++ container that an unknown function gets while it is empty."""
    for value in arguments.values if machine.runtime.passes_by_reference else ():
        if isinstance(value, (ListValue, MapValue)) and not truth(value):
            open_container(machine, value)


def open_container(machine: AbstractMachine, value: Value) -> None:
    """Leave open what else is in a container."""
    if isinstance(value, ListValue):
        machine.undo_log.mark_open(value.fields)
    elif isinstance(value, MapValue) and not value.open:
        machine.undo_log.set(value.fields, OPEN, UNKNOWN)


def _forget_written_strings(machine: AbstractMachine, name: str, arguments: Arguments) -> None:
    """Forget the strings that an unknown C++ function may have changed."""
    for slot in filter(None, arguments.slots):
        before = slot.holder.get(slot.key)
        if isinstance(before, (Scalar, PartialText)) and is_text(before):
            after = Unknown(slot.label, is_tainted(before))
            machine.undo_log.set(
                *slot, after if name in MUTATING_FUNCTIONS else join((before, after))
            )

"""What code that is not here may write to: what it gets by reference or by its address."""

from typing import Any

from rtron.sources.code.interpreter import abstract_values as av
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
        if isinstance(value, av.ListValue):
            _forget_array(machine, value)


def _forget_variable(machine: AbstractMachine, holder: dict[Any, av.Value], key: Any) -> None:  # noqa: ANN401
    """Let a variable hold anything beside what it holds; of an object, each member of its own."""
    value = holder.get(key)
    if isinstance(value, av.Scalar) and not av.is_text(value):
        machine.undo_log.set(holder, key, _or_unknown(value))
    elif isinstance(value, av.ListValue):
        _forget_array(machine, value)
    elif isinstance(value, av.Instance) and isinstance(value.type, av.ClassValue):
        for name, member in list(value.fields.items()):
            if isinstance(member, av.Scalar) and not av.is_text(member):
                machine.undo_log.set(value.fields, name, _or_unknown(member))


def _forget_array(machine: AbstractMachine, array: av.ListValue) -> None:
    if array.type is not None and array.type.name == "std::array":
        machine.undo_log.set(array.fields, "items", tuple(map(_or_unknown, array.items)))


def _or_unknown(value: av.Value) -> av.Value:
    is_number = isinstance(value, av.Scalar) and not av.is_text(value)
    return av.join((value, av.Unknown("written", av.is_tainted(value)))) if is_number else value


def _open_empty_containers(machine: AbstractMachine, arguments: Arguments) -> None:
    """Leave open what is in a C++ container that an unknown function gets while it is empty."""
    for value in arguments.values if machine.runtime.passes_by_reference else ():
        if isinstance(value, (av.ListValue, av.MapValue)) and not av.truth(value):
            open_container(machine, value)


def open_container(machine: AbstractMachine, value: av.Value) -> None:
    """Leave open what else is in a container."""
    if isinstance(value, av.ListValue):
        machine.undo_log.mark_open(value.fields)
    elif isinstance(value, av.MapValue) and not value.open:
        machine.undo_log.set(value.fields, av.OPEN, av.UNKNOWN)


def _forget_written_strings(machine: AbstractMachine, name: str, arguments: Arguments) -> None:
    """Forget the strings that an unknown C++ function may have changed."""
    for slot in filter(None, arguments.slots):
        before = slot.holder.get(slot.key)
        if isinstance(before, (av.Scalar, av.PartialText)) and av.is_text(before):
            after = av.Unknown(slot.label, av.is_tainted(before))
            machine.undo_log.set(
                *slot, after if name in MUTATING_FUNCTIONS else av.join((before, after))
            )

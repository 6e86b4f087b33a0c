"""Files that C++ reads as a whole: `std::ifstream`, and what its text goes into (cppreference.com).

Only files of packages are read. What a program reads of a file line by line stays unknown.
"""

from pathlib import Path

from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    TRUE,
    Instance,
    LibraryClass,
    Scalar,
    Unknown,
    Value,
    is_text,
    map_options,
    options,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments

_TEXT, _STATE = "file.text", "truth"
_NOT_READ = Unknown("file")


def _open_file(machine: AbstractMachine, arguments: Arguments) -> Value:
    """`std::ifstream file(path)`."""
    made = Instance(FILE, {_TEXT: _NOT_READ, _STATE: _NOT_READ})
    if arguments.values:
        _read_file(machine, made, arguments)
    return made


def _read_file(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`file.open(path)`."""

    def text_of(path: Value) -> Value:
        if not (isinstance(path, Scalar) and is_text(path)):
            return _NOT_READ
        found = machine.runtime.files.read_text(Path(str(path.value)))
        return _NOT_READ if found is None else Scalar(found)

    text = map_options(arguments.value(0), text_of)
    machine.undo_log.set(owner.fields, _TEXT, text)
    machine.undo_log.set(owner.fields, _STATE, TRUE if _is_known(text) else _NOT_READ)
    return NONE


def _is_known(text: Value) -> bool:
    return all(isinstance(option, Scalar) for option in options(text))


def _state(_: AbstractMachine, owner: Instance, __: Arguments) -> Value:
    """`file.good()`, `file.is_open()`."""
    return owner.fields[_STATE]


def _failed(_: AbstractMachine, owner: Instance, __: Arguments) -> Value:
    """`file.fail()`."""
    return Scalar(value=False) if owner.fields[_STATE] == TRUE else _NOT_READ


def _buffer(_: AbstractMachine, owner: Instance, __: Arguments) -> Value:
    """`text << file.rdbuf()`."""
    return owner.fields[_TEXT]


def make_buffer_iterator(_: AbstractMachine, arguments: Arguments) -> Value:
    """`std::istreambuf_iterator<char>(file)`, of which with an end a text is made."""
    file = arguments.get(0)
    return file.fields[_TEXT] if isinstance(file, Instance) and file.type is FILE else NONE


FILE = LibraryClass(
    "std::ifstream",
    _open_file,
    {
        "open": _read_file,
        **dict.fromkeys(("good", "is_open"), _state),
        **dict.fromkeys(("fail", "bad", "operator!"), _failed),
        "rdbuf": _buffer,
    },
)

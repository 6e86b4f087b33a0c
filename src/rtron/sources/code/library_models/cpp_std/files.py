"""Files that C++ reads as a whole: `std::ifstream`, and what its text goes into (cppreference.com).

Only files of packages are read. What a program reads of a file line by line stays unknown.
"""

from pathlib import Path

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.trivial_functions import returning_field

_TEXT, _STATE = "file.text", "truth"
_NOT_READ = av.Unknown("file")


def _open_file(machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """`std::ifstream file(path)`."""
    made = av.Instance(FILE, {_TEXT: _NOT_READ, _STATE: _NOT_READ})
    if arguments.values:
        _read_file(machine, made, arguments)
    return made


def _read_file(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`file.open(path)`."""

    def text_of(path: av.Value) -> av.Value:
        if not (isinstance(path, av.Scalar) and av.is_text(path)):
            return _NOT_READ
        found = machine.runtime.files.read_text(Path(str(path.value)))
        return _NOT_READ if found is None else av.Scalar(found)

    text = av.map_options(arguments.value(0), text_of)
    machine.undo_log.set(owner.fields, _TEXT, text)
    machine.undo_log.set(owner.fields, _STATE, av.TRUE if _is_known(text) else _NOT_READ)
    return av.NONE


def _is_known(text: av.Value) -> bool:
    return all(isinstance(option, av.Scalar) for option in av.options(text))


def _failed(_: AbstractMachine, owner: av.Instance, __: Arguments) -> av.Value:
    """`file.fail()`."""
    return av.Scalar(value=False) if owner.fields[_STATE] == av.TRUE else _NOT_READ


def make_buffer_iterator(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """`std::istreambuf_iterator<char>(file)`, of which with an end a text is made."""
    file = arguments.get(0)
    return file.fields[_TEXT] if isinstance(file, av.Instance) and file.type is FILE else av.NONE


FILE = av.LibraryClass(
    "std::ifstream",
    _open_file,
    {
        "open": _read_file,
        **dict.fromkeys(("good", "is_open"), returning_field(_STATE)),
        **dict.fromkeys(("fail", "bad", "operator!"), _failed),
        "rdbuf": returning_field(_TEXT),
    },
)

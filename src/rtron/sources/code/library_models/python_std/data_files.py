"""YAML and JSON files of the workspace that a Python program reads itself."""

import json
from collections.abc import Mapping
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.code.interpreter.abstract_values.value_types import (
    Instance,
    LibraryFunction,
    Scalar,
    Unknown,
    Value,
    map_options,
    options,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.python_std.builtin_functions import FILE
from rtron.sources.code.library_models.ros1_common.names import abstract_value
from rtron.sources.launch.common.yaml_tree import parse_yaml, plain_value


def _load_file(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`yaml.load(open(path))`, `json.load(stream)`; JSON is read as the YAML it is."""

    def loaded(stream: Value) -> Value:
        text = _file_text(machine, stream)
        return _parse(text) if text is not None else Unknown("file")

    return map_options(arguments.value(0), loaded)


def _dump(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`json.dumps(value)` of a number or a text."""

    def dumped(value: Value) -> Value:
        if not isinstance(value, Scalar) or isinstance(value.value, bytes):
            return Unknown("json")
        return Scalar(json.dumps(value.value), value.tainted)

    return map_options(arguments.value(0), dumped)


def _file_text(machine: AbstractMachine, stream: Value) -> str | None:
    if isinstance(stream, Instance) and stream.type is FILE:
        path, read = stream.fields["path"], machine.runtime.files.read_text
        return read(Path(str(path.value))) if isinstance(path, Scalar) else None
    return str(stream.value) if isinstance(stream, Scalar) else None


def _parse(text: str) -> Value:
    try:
        documents = parse_yaml(text, "").documents
    except InputError:
        return Unknown("file")
    found = documents[0] if documents else None
    return Unknown("file") if found is None else abstract_value(plain_value(found), "file")


def _read_file(machine: AbstractMachine, owner: Instance, _: Arguments) -> Value:
    found = [
        _file_text(machine, Instance(FILE, {"path": path}))
        for path in options(owner.fields["path"])
    ]
    text = found[0] if len(found) == 1 else None
    return Unknown("file") if text is None else Scalar(text, tainted=True)


FILE.methods["read"] = _read_file
DATA_FILE_FUNCTIONS: Mapping[str, Value] = {
    "json.dumps": LibraryFunction("json.dumps", _dump),
    **{
        name: LibraryFunction(name, _load_file)
        for name in ("yaml.load", "yaml.safe_load", "yaml.full_load", "json.load", "json.loads")
    },
}

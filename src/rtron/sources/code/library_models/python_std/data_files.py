"""YAML and JSON files of the workspace that a Python program reads itself."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.python_std.builtin_functions import FILE
from rtron.sources.code.library_models.ros1_common.names import abstract_value
from rtron.sources.launch.common.yaml_tree import parse_yaml, plain_value


def _load_file(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`yaml.load(open(path))`, `json.load(stream)`; JSON is read as the YAML it is."""

    def loaded(stream: av.Value) -> av.Value:
        text = _file_text(machine, stream)
        return _parse(text) if text is not None else av.Unknown("file")

    return av.map_options(arguments.value(0), loaded)


def _dump(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`json.dumps(value)` of a number or a text."""

    def dumped(value: av.Value) -> av.Value:
        if not isinstance(value, av.Scalar) or isinstance(value.value, bytes):
            return av.Unknown("json")
        return av.Scalar(json.dumps(value.value), value.tainted)

    return av.map_options(arguments.value(0), dumped)


def _file_text(machine: AbstractMachine, stream: av.Value) -> str | None:
    if isinstance(stream, av.Instance) and stream.type is FILE:
        path, read = stream.fields["path"], machine.runtime.files.read_text
        return read(Path(str(path.value))) if isinstance(path, av.Scalar) else None
    return str(stream.value) if isinstance(stream, av.Scalar) else None


def _parse(text: str) -> av.Value:
    try:
        documents = parse_yaml(text, "").documents
    except InputError:
        return av.Unknown("file")
    found = documents[0] if documents else None
    return av.Unknown("file") if found is None else abstract_value(plain_value(found), "file")


def _read_file(machine: AbstractMachine, owner: av.Instance, _: Arguments) -> av.Value:
    found = [
        _file_text(machine, av.Instance(FILE, {"path": path}))
        for path in av.options(owner.fields["path"])
    ]
    text = found[0] if len(found) == 1 else None
    return av.Unknown("file") if text is None else av.Scalar(text, tainted=True)


FILE.methods["read"] = _read_file
DATA_FILE_FUNCTIONS: Mapping[str, Callable[..., av.Value]] = {
    "json.dumps": _dump,
    **dict.fromkeys(
        ("yaml.load", "yaml.safe_load", "yaml.full_load", "json.load", "json.loads"), _load_file
    ),
}

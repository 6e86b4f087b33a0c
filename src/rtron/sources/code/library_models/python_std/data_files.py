"""YAML and JSON files of the workspace that a Python program reads itself."""

from collections.abc import Mapping
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.code.interpreter.abstract_values.value_types import (
    Hole,
    Instance,
    Known,
    Native,
    Value,
    each,
    options,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.python_std.builtin_functions import FILE
from rtron.sources.code.library_models.ros1_common.names import value_of
from rtron.sources.launch.common.yaml_tree import parse_yaml, plain


def _load(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`yaml.load(open(path))`, `json.load(stream)`; JSON is read as the YAML it is."""

    def loaded(stream: Value) -> Value:
        text = _text(machine, stream)
        return _parsed(text) if text is not None else Hole("file")

    return each(arguments.get(0) or Hole("?"), loaded)


def _text(machine: Machine, stream: Value) -> str | None:
    if isinstance(stream, Instance) and stream.type is FILE:
        path = stream.fields["path"]
        return machine.world.files.text(Path(str(path.value))) if isinstance(path, Known) else None
    return str(stream.value) if isinstance(stream, Known) else None


def _parsed(text: str) -> Value:
    try:
        documents = parse_yaml(text, "").documents
    except InputError:
        return Hole("file")
    found = documents[0] if documents else None
    return Hole("file") if found is None else value_of(plain(found), "file")


def _read(machine: Machine, owner: Instance, _: Arguments) -> Value:
    found = [
        _text(machine, Instance(FILE, {"path": path})) for path in options(owner.fields["path"])
    ]
    text = found[0] if len(found) == 1 else None
    return Hole("file") if text is None else Known(text, tainted=True)


FILE.methods["read"] = _read
PYTHON_FILES: Mapping[str, Value] = {
    name: Native(name, _load)
    for name in ("yaml.load", "yaml.safe_load", "yaml.full_load", "json.load", "json.loads")
}

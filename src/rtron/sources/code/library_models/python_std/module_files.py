"""Modules that a program loads by their files: importlib.util, importlib.machinery, imp."""

from collections.abc import Callable, Mapping
from pathlib import Path

from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Instance,
    LibraryClass,
    LibraryFunction,
    Scalar,
    Unknown,
    Value,
    map_options,
    text_with_holes,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.language_runtime import python_runtime
from rtron.sources.code.library_models.python_std.dynamic_code import HIDDEN_CODE_REASON


def _load(machine: AbstractMachine, name: Value, path: Value, arguments: Arguments) -> Value:
    """Return the module of a file; one that is not in the workspace is noted."""

    def loaded(one: Value) -> Value:
        file = Path(str(one.value)) if isinstance(one, Scalar) else None
        if file is None or machine.runtime.files.read_text(file) is None:
            what = f"import of {text_with_holes(one)}"
            machine.recorder.add_unresolved(what, HIDDEN_CODE_REASON, arguments.evidence)
            return Unknown("module")
        return python_runtime(machine).load_module(file.resolve(), text_with_holes(name))

    return map_options(path, loaded)


def _load_source(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`imp.load_source(name, path)`."""
    name, path = arguments.get(0, "name") or NONE, arguments.get(1, "pathname") or NONE
    return _load(machine, name, path, arguments)


def _specification(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`spec_from_file_location(name, path)`, and `SourceFileLoader(name, path)`."""
    name = arguments.get(0, "name") or arguments.get(0, "fullname") or NONE
    path = arguments.get(1, "location") or arguments.get(1, "path") or NONE
    loader = Instance(_LOADER, {"name": name, "origin": path})
    return Instance(_LOADER, loader.fields | {"loader": loader})


def _module(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`module_from_spec(spec)`: with what its file defines."""
    specification = arguments.get(0, "spec")
    if not isinstance(specification, Instance) or specification.type is not _LOADER:
        return Unknown("module")
    return _load_specified(machine, specification, arguments)


def _load_specified(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`loader.load_module()`."""
    return _load(machine, owner.fields["name"], owner.fields["origin"], arguments)


def _execute_module(_: AbstractMachine, __: object, ___: Arguments) -> Value:
    """`loader.exec_module(module)`: it has run when the module was made."""
    return NONE


_LOADER = LibraryClass(
    "importlib.machinery.SourceFileLoader",
    methods={"load_module": _load_specified, "exec_module": _execute_module},
)
_CALLS: Mapping[str, Callable[..., Value]] = {
    "imp.load_source": _load_source,
    "importlib.machinery.SourceFileLoader": _specification,
    "importlib.util.module_from_spec": _module,
    "importlib.util.spec_from_file_location": _specification,
}
MODULE_FILES: Mapping[str, Value] = {
    name: LibraryFunction(name, call) for name, call in _CALLS.items()
}

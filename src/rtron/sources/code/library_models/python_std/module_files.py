"""Modules that a program loads by their files: importlib.util, importlib.machinery, imp."""

from collections.abc import Callable, Mapping
from pathlib import Path

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.language_runtime import python_runtime
from rtron.sources.code.library_models.python_std.dynamic_code import HIDDEN_CODE_REASON


def _load(
    machine: AbstractMachine, name: av.Value, path: av.Value, arguments: Arguments
) -> av.Value:
    """Return the module of a file; one that is not in the workspace is noted."""

    def loaded(one: av.Value) -> av.Value:
        file = Path(str(one.value)) if isinstance(one, av.Scalar) else None
        if file is None or machine.runtime.files.read_text(file) is None:
            what = f"import of {av.text_with_holes(one)}"
            machine.recorder.add_unresolved(what, HIDDEN_CODE_REASON, arguments.evidence)
            return av.Unknown("module")
        return python_runtime(machine).load_module(file.resolve(), av.text_with_holes(name))

    return av.map_options(path, loaded)


def _load_source(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`imp.load_source(name, path)`."""
    name, path = arguments.get(0, "name") or av.NONE, arguments.get(1, "pathname") or av.NONE
    return _load(machine, name, path, arguments)


def _specification(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`spec_from_file_location(name, path)`, and `SourceFileLoader(name, path)`."""
    name = arguments.get(0, "name") or arguments.get(0, "fullname") or av.NONE
    path = arguments.get(1, "location") or arguments.get(1, "path") or av.NONE
    loader = av.Instance(_LOADER, {"name": name, "origin": path})
    return av.Instance(_LOADER, loader.fields | {"loader": loader})


def _module(machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    """`module_from_spec(spec)`: with what its file defines."""
    specification = arguments.get(0, "spec")
    if not isinstance(specification, av.Instance) or specification.type is not _LOADER:
        return av.Unknown("module")
    return _load_specified(machine, specification, arguments)


def _load_specified(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`loader.load_module()`."""
    return _load(machine, owner.fields["name"], owner.fields["origin"], arguments)


def _execute_module(_: AbstractMachine, __: object, ___: Arguments) -> av.Value:
    """`loader.exec_module(module)`: it has run when the module was made."""
    return av.NONE


_LOADER = av.LibraryClass(
    "importlib.machinery.SourceFileLoader",
    methods={"load_module": _load_specified, "exec_module": _execute_module},
)
MODULE_FILES: Mapping[str, Callable[..., av.Value]] = {
    "imp.load_source": _load_source,
    "importlib.machinery.SourceFileLoader": _specification,
    "importlib.util.module_from_spec": _module,
    "importlib.util.spec_from_file_location": _specification,
}

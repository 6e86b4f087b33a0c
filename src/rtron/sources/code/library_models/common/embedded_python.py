"""Python that a C++ program runs in its own process (pybind11: embed.h).

`module::import("m").attr("C")(…)` calls C of the module m: it is run after the program, as a part
of it, with arguments that are not known. What is run of a text is noted.
"""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import (
    UNKNOWN,
    Instance,
    LibraryClass,
    Scalar,
    Unknown,
    Value,
    text_with_holes,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments

_MODULE, _NAME = "module", "name"


def _import(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`module::import(name)`."""
    return Instance(_OBJECT, {_MODULE: arguments.value(0)})


def _attribute(_: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`object.attr(name)`; what stands in an object of a module is not known."""
    if _NAME in owner.fields:
        return Unknown("attr")
    return Instance(_OBJECT, {**owner.fields, _NAME: arguments.value(0)})


def _call(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`object(…)`."""
    module, name = owner.fields.get(_MODULE, UNKNOWN), owner.fields.get(_NAME, UNKNOWN)
    if isinstance(module, Scalar) and isinstance(name, Scalar):
        if not machine.trial_depth:
            called = str(module.value), str(name.value)
            machine.python_calls.setdefault(called, arguments.evidence)
    else:
        _note(f"Python of {text_with_holes(module)}", machine, None, arguments)
    return UNKNOWN


def _note(what: str, machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    why = "the Python that it runs is not known here: what that joins is missing"
    machine.recorder.add_unresolved(what, why, arguments.evidence)
    return UNKNOWN


_OBJECT = LibraryClass("pybind11::object", methods={"attr": _attribute, "operator()": _call})
EMBEDDED_PYTHON: Mapping[str, Callable[..., Value]] = {
    "pybind11::module::import": _import,
    "pybind11::module_::import": _import,
    **{f"pybind11::{name}": partial(_note, name) for name in ("exec", "eval", "eval_file")},
}

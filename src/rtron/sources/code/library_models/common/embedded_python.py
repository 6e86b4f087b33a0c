"""Python that a C++ program runs in its own process (pybind11: embed.h).

`module::import("m").attr("C")(…)` calls C of the module m: it is run after the program, as a part
of it, with arguments that are not known. What is run of a text is noted.
"""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments

_MODULE, _NAME = "module", "name"


def _import(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`module::import(name)`."""
    return av.Instance(_OBJECT, {_MODULE: arguments.value(0)})


def _attribute(_: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`object.attr(name)`; what stands in an object of a module is not known."""
    if _NAME in owner.fields:
        return av.Unknown("attr")
    return av.Instance(_OBJECT, {**owner.fields, _NAME: arguments.value(0)})


def _call(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    """`object(…)`."""
    module, name = owner.fields.get(_MODULE, av.UNKNOWN), owner.fields.get(_NAME, av.UNKNOWN)
    if isinstance(module, av.Scalar) and isinstance(name, av.Scalar):
        if not machine.trial_depth:
            called = str(module.value), str(name.value)
            machine.python_calls.setdefault(called, arguments.evidence)
    else:
        _note(f"Python of {av.text_with_holes(module)}", machine, None, arguments)
    return av.UNKNOWN


def _note(what: str, machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
    why = "the Python that it runs is not known here: what that joins is missing"
    machine.recorder.add_unresolved(what, why, arguments.evidence)
    return av.UNKNOWN


_OBJECT = av.LibraryClass("pybind11::object", methods={"attr": _attribute, "operator()": _call})
EMBEDDED_PYTHON: Mapping[str, Callable[..., av.Value]] = {
    "pybind11::module::import": _import,
    "pybind11::module_::import": _import,
    **{f"pybind11::{name}": partial(_note, name) for name in ("exec", "eval", "eval_file")},
}

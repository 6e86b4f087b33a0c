"""What differs between the languages, as the machine uses it."""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Protocol, cast

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.source_provider import SourceProvider
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame, StorageSlot

if TYPE_CHECKING:
    from rtron.sources.code.interpreter.cpp.runtime import CppRuntime
    from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
    from rtron.sources.code.interpreter.python.runtime import PythonRuntime


class LanguageRuntime(Protocol):
    """The names a program can see, and how its objects are made.

    `passes_by_reference` says that a call may write to what it is given (C++).
    """

    passes_by_reference: bool
    files: SourceProvider

    def lookup(self, name: ir.Name, frame: StackFrame) -> av.Value:
        """Return what a name means; an Unknown or ExternalSymbol where that is not known."""

    def slot(self, name: str, frame: StackFrame) -> StorageSlot:
        """Return where a name is kept when it is assigned to."""

    def is_constant(self, name: str, frame: StackFrame) -> bool:
        """Tell whether a name is of a constant: whoever is given it cannot change it."""

    def attribute(
        self, owner: av.Value, name: str, types: tuple[ir.TypeRef, ...]
    ) -> av.Value | None:
        """Return a member of a value, bound to it; None where it has none of that name."""

    def special_method(self, owner: av.Value, name: str) -> av.Value | None:
        """Return the method that a scanned class of Python has for an operation: `__getitem__`."""

    def shown(self, value: av.Value) -> av.Value:
        """Return a value as a text shows it: an object of a scanned class by its `__str__`."""

    def iterate(self, value: av.Value) -> tuple[tuple[av.Value, ...], bool]:
        """Return what a loop over a value sees, and whether that is all."""

    def call_frame(self, called: av.FunctionValue, arguments: Arguments) -> StackFrame:
        """Return the frame that a call of a scanned function runs in, its parameters bound."""

    def instantiate(self, called: av.Value, arguments: Arguments) -> av.Value:
        """Make an object of a scanned class."""

    def method_names(self, definition: ir.Class) -> list[str]:
        """Return the names of the methods that a class defines itself."""

    def lineage(self, cls: av.Value) -> Iterator[av.Value]:
        """Yield a class and its bases, in the order in which a member is looked for."""

    def functions_named(self, name: str) -> tuple[ir.Function, ...]:
        """Return the scanned functions with a plain name, in whatever class."""

    def related_names(self, function: ir.Function) -> frozenset[str]:
        """Return the plain names of what a function may call."""

    def calls_unknown(self, function: ir.Function) -> bool:
        """Tell whether a function calls what its source does not name."""

    def find_by_arguments(self, name: str, arguments: Arguments) -> av.Value | None:
        """Return what a call finds by its arguments alone: C++ looks beside their classes."""

    def note_unknown_call(self, called: av.Value, arguments: Arguments) -> None:
        """Note a call of what is not in the source, if it may join nodes."""

    def missing_package(self, name: str) -> str:
        """Return the package that has what is called by a name, if it tells and is not here."""

    def version(self) -> int:
        """Return a number that changes when the program's functions do."""

    def program_functions(self) -> Iterator[tuple[str, ir.Function]]:
        """Yield the functions of the program's own files, each with what it is called by."""

    def module_variables(self) -> Iterator[Mapping[str, av.Value]]:
        """Yield the variables of each module of the program, or those of namespaces."""


def python_runtime(machine: "AbstractMachine") -> "PythonRuntime":
    """Return the machine's runtime, where only Python's is met."""
    return cast("PythonRuntime", machine.runtime)


def cpp_runtime(machine: "AbstractMachine") -> "CppRuntime":
    """Return the machine's runtime, where only C++'s is met, as in library models of C++."""
    return cast("CppRuntime", machine.runtime)

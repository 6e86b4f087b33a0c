"""Python's names and calls."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.arguments import (
    Arguments,
    bind_parameters,
    evaluate_defaults,
)
from rtron.sources.code.interpreter.execution.calls import callee_name
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame, StorageSlot
from rtron.sources.code.interpreter.python.objects import PythonObjects
from rtron.sources.code.interpreter.python.unknown_calls import (
    is_computing_package,
    note_unknown_call,
)
from rtron.sources.code.library_models.common.containers import bound_method
from rtron.sources.code.library_models.common.maps import DICT_METHODS
from rtron.sources.code.library_models.common.strings import (
    PYTHON_STRING_METHODS,
    bound_string_method,
)
from rtron.sources.code.library_models.python_std.environment import (
    ENVIRONMENT_METHODS,
    EnvironmentValue,
)
from rtron.sources.code.library_models.python_std.list_methods import PYTHON_LIST_METHODS
from rtron.sources.code.library_models.python_std.paths import PathString, path_member


@dataclass(eq=False, slots=True, kw_only=True)
class PythonRuntime(PythonObjects):
    """One program, as the machine runs it."""

    builtins: Mapping[str, av.Value]
    _seen_packages: set[str] = field(default_factory=set)

    passes_by_reference = False

    def lookup(self, name: ir.Name, frame: StackFrame) -> av.Value:
        """Return what a name means: local, enclosing, of the module, built in."""
        around: StackFrame | None = frame
        while around is not None:
            if name.id in around.globals:
                around = _module_frame(around)
            if name.id in around.variables:
                found: av.Value = around.variables[name.id]
                return (
                    self.machine.volatile_value(name.id, found) if around.closure is None else found
                )
            root, around = around, around.closure
        if name.id in self.builtins:
            return self.builtins[name.id]
        return self._star_imported_name(name.id, root) or av.Unknown(name.id)

    def slot(self, name: str, frame: StackFrame) -> StorageSlot:
        """Return where an assignment to a name goes."""
        if name in frame.globals:
            return StorageSlot(_module_frame(frame).variables, name)
        around = frame
        while name in frame.nonlocals and around.closure is not None:
            around = around.closure
            if name in around.variables:
                return StorageSlot(around.variables, name)
        return StorageSlot(frame.variables, name)

    def is_constant(self, name: str, frame: StackFrame) -> bool:
        """Python has no constants."""
        del name, frame
        return False

    def attribute(
        self, owner: av.Value, name: str, types: tuple[ir.TypeRef, ...]
    ) -> av.Value | None:
        """Return a member, bound to its owner."""
        del types
        if isinstance(owner, av.Instance):
            return self._instance_member(owner, name)
        if isinstance(owner, (av.ClassValue, av.LibraryClass)):
            return self._class_attribute(owner, name)
        if isinstance(owner, (av.ModuleValue, av.ExternalSymbol, av.LibraryFunction)):
            return self._module_member(owner, name)
        if isinstance(owner, av.FunctionValue):
            return _function_member(owner, name)
        return _value_member(owner, name)

    def find_by_arguments(self, name: str, arguments: Arguments) -> av.Value | None:
        """Python finds what it calls by the name alone."""
        del name, arguments
        return None

    def note_unknown_call(self, called: av.Value, arguments: Arguments) -> None:
        """Note a call of what is not in the source, if it may join nodes; a package once."""
        note_unknown_call(self.machine, called, arguments, self._is_known, self._is_foreign_package)
        if self.missing_package(callee_name(called)):
            for cls in (each for each in arguments.all_values if isinstance(each, av.ClassValue)):
                self.take_handed_class(cls, arguments)

    def missing_package(self, name: str) -> str:
        """Return the module that a name begins with, if it is none of Python's or RTron's."""
        first, _, rest = name.partition(".")
        return first if rest and not self._is_known(first) else ""

    def _is_foreign_package(self, name: str) -> bool:
        """Tell whether a module is a package of ROS that is not here; once for each."""
        if name in self._seen_packages or self._is_known(name):
            return False
        self._seen_packages.add(name)
        script = next(iter(self._modules), None)
        is_package = script is not None and self.files.is_dependency(name, script)
        return is_package and not is_computing_package(name)

    def define(self, node: ir.Define, frame: StackFrame) -> None:
        """Bind a function or class by its name, under its decorators."""
        if isinstance(node.definition, ir.Class):
            value: av.Value = self._create_class(node.definition, frame)
        else:
            named = evaluate_defaults(
                node.definition, lambda default: self.machine.evaluate(default, frame)
            )
            around = frame.closure if frame.body == "class" else frame
            value = av.FunctionValue(node.definition, closure=around, bound_keywords=named)
        for decorator in reversed(node.decorators):
            value = self._apply_decorator(self.machine.evaluate(decorator, frame), value, frame)
        self.machine.undo_log.set(*self.slot(node.definition.name, frame), value)

    def call_frame(self, called: av.FunctionValue, arguments: Arguments) -> StackFrame:
        """Return the frame of a call."""
        bound = () if called.owner is None else (called.owner,)
        passed = Arguments(
            values=(*bound, *called.bound_arguments, *arguments.values),
            keywords={**called.bound_keywords, **arguments.keywords},
            line=arguments.line,
            frame=arguments.frame,
        )
        closure = called.closure or arguments.frame
        variables = bind_parameters(
            called.function.params, passed, lambda node: self.machine.evaluate(node, closure)
        )
        return StackFrame(
            file=called.function.file,
            function=called.function,
            variables=variables,
            closure=closure,
            cls=called.cls,
            caller=arguments,
        )


def _module_frame(frame: StackFrame) -> StackFrame:
    while frame.closure is not None:
        frame = frame.closure
    return frame


def _function_member(owner: av.FunctionValue, name: str) -> av.Value | None:
    """Return a member of a function: what `@singledispatch` and the like add is none of ours."""
    if name in {"__name__", "__qualname__"}:
        return av.Scalar(owner.function.name)
    return owner if name in {"__call__", "__func__", "__wrapped__"} else None


def _value_member(owner: av.Value, name: str) -> av.Value | None:
    """Return a method of a list, a dictionary or a text."""
    if isinstance(owner, av.ListValue):
        return bound_method(PYTHON_LIST_METHODS, owner, name)
    if isinstance(owner, EnvironmentValue):
        return bound_method(ENVIRONMENT_METHODS, owner, name)
    if isinstance(owner, av.MapValue):
        return bound_method(DICT_METHODS, owner, name)
    if isinstance(owner, av.Scalar) and isinstance(owner.value, PathString):
        member = path_member(owner, name)
        if member is not None:
            return member
    if av.is_text(owner):
        return bound_string_method(PYTHON_STRING_METHODS, owner, name)
    return None

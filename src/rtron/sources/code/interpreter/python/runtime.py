"""Python's names and calls."""

from collections.abc import Mapping
from dataclasses import dataclass

from rtron.sources.code.interpreter.abstract_values.value_types import (
    ClassValue,
    Foreign,
    FunctionValue,
    Hole,
    Instance,
    Known,
    ListValue,
    MapValue,
    ModuleValue,
    Native,
    NativeClass,
    Text,
    Value,
)
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.binding import bind, defaults
from rtron.sources.code.interpreter.execution.stack_frame import Frame, Place
from rtron.sources.code.interpreter.python.objects import PythonObjects
from rtron.sources.code.ir import Class, Declare, Define, Lambda, Name, New, TypeRef
from rtron.sources.code.library_models.common.containers import LIST, PYTHON_MAP, bound
from rtron.sources.code.library_models.common.strings import PYTHON_TEXT, text_method
from rtron.sources.code.library_models.python_std.environment import ENVIRONMENT, Environment
from rtron.sources.code.library_models.python_std.paths import PathText, path_member


@dataclass(eq=False, slots=True, kw_only=True)
class PythonWorld(PythonObjects):
    """One program as the machine asks for it."""

    builtins: Mapping[str, Value]

    by_reference = False

    def lookup(self, name: Name, frame: Frame) -> Value:
        """Return what a name means: local, enclosing, of the module, built in."""
        around: Frame | None = frame
        while around is not None:
            if name.id in around.variables:
                found: Value = around.variables[name.id]
                return self.machine.seen(name.id, found) if around.closure is None else found
            root, around = around, around.closure
        if name.id in self.builtins:
            return self.builtins[name.id]
        return self._starred(name.id, root) or Hole(name.id)

    def place(self, name: str, frame: Frame) -> Place:
        """Return where an assignment to a name goes."""
        if name in frame.globals:
            around = frame
            while around.closure is not None:
                around = around.closure
                if name in around.variables:
                    break
            return Place(around.variables, name)
        return Place(frame.variables, name)

    def is_constant(self, name: str, frame: Frame) -> bool:
        """Python has no constants."""
        del name, frame
        return False

    def attribute(self, owner: Value, name: str, types: tuple[TypeRef, ...]) -> Value | None:
        """Return a member, bound to its owner."""
        del types
        if isinstance(owner, Instance):
            return self._of_instance(owner, name)
        if isinstance(owner, (ClassValue, NativeClass)):
            return self._of_type(owner, name)
        if isinstance(owner, (ModuleValue, Foreign, Native)):
            return self._of_module(owner, name)
        return _of_value(owner, name)

    def new(self, node: New, frame: Frame) -> Value:
        """Python has no `new`."""
        raise TypeError(node, frame)

    def declare(self, node: Declare, frame: Frame) -> None:
        """Python has no declarations."""
        raise TypeError(node, frame)

    def around(self, node: Lambda, frame: Frame) -> Frame:
        """Python's lambdas share all."""
        raise TypeError(node, frame)

    def define(self, node: Define, frame: Frame) -> None:
        """Bind a function or class by its name, under its decorators."""
        if isinstance(node.what, Class):
            value: Value = self._class(node.what, frame)
        else:
            named = defaults(node.what, lambda default: self.machine.evaluate(default, frame))
            value = FunctionValue(node.what, closure=frame, named=named)
        for decorator in reversed(node.decorators):
            value = self._decorated(self.machine.evaluate(decorator, frame), value, frame)
        self.machine.trail.set(*self.place(node.what.name, frame), value)

    def frame(self, called: FunctionValue, arguments: Arguments) -> Frame:
        """Return the frame of a call."""
        given = called.given if called.owner is None else (called.owner, *called.given)
        passed = Arguments(
            values=(*given, *arguments.values),
            keywords={**called.named, **arguments.keywords},
            line=arguments.line,
            frame=arguments.frame,
        )
        closure = called.closure or arguments.frame
        variables = bind(
            called.function.params, passed, lambda node: self.machine.evaluate(node, closure)
        )
        return Frame(
            file=called.function.file,
            function=called.function,
            variables=variables,
            closure=closure,
            cls=called.cls,
            caller=arguments,
        )


def _of_value(owner: Value, name: str) -> Value | None:
    """Return a method of a list, a dictionary or a text."""
    if isinstance(owner, ListValue):
        return bound(LIST, owner, name)
    if isinstance(owner, Environment):
        return bound(ENVIRONMENT, owner, name)
    if isinstance(owner, MapValue):
        return bound(PYTHON_MAP, owner, name)
    if isinstance(owner, Known) and isinstance(owner.value, PathText):
        member = path_member(owner, name)
        if member is not None:
            return member
    if isinstance(owner, Text) or (isinstance(owner, Known) and isinstance(owner.value, str)):
        return text_method(PYTHON_TEXT, owner, name)
    return None

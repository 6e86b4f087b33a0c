"""Calls of C++ functions: the frame that one runs in."""

from dataclasses import dataclass, field, replace

from rtron.sources.code.interpreter.abstract_values.value_types import (
    ClassValue,
    FunctionValue,
    Hole,
    Instance,
    ListValue,
    MapValue,
    Placeholder,
    Value,
)
from rtron.sources.code.interpreter.cpp.types import CppTypes
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.binding import bind
from rtron.sources.code.interpreter.execution.stack_frame import Frame
from rtron.sources.code.ir import Expr, Param
from rtron.sources.code.library_models.common.containers import copied


@dataclass(eq=False, slots=True, kw_only=True)
class CppCalls(CppTypes):
    """The calls of one program."""

    machine: Machine = field(init=False)

    def frame(self, called: FunctionValue, arguments: Arguments) -> Frame:
        """Return the frame of a call: parameters bound, references to the caller's places."""
        function = called.function
        passed = _given(called, arguments)
        outer = called.closure
        frame = Frame(
            file=function.file,
            function=function,
            closure=outer if isinstance(outer, Frame) else None,
            this=called.owner if called.owner is not None else getattr(outer, "this", None),
            cls=called.cls,
            scope=getattr(outer, "scope", "") or function.name.rpartition("::")[0],
            types=self.bound_types(called, passed),
            caller=arguments,
            constants={param.name: param.constant for param in function.params},
        )

        def default(node: Expr) -> Value:
            types = frame.types
            around = Frame(file=function.file, scope=frame.scope, this=frame.this, types=types)
            return self.machine.evaluate(node, around)

        frame.variables = bind(function.params, passed, default)
        for at, param in enumerate(function.params):
            place = passed.place(at)
            if param.reference and place is not None and place.key != "this":
                frame.aliases[param.name] = place
            elif not param.reference and param.kind == "plain":
                value = frame.variables[param.name]
                if isinstance(value, (Instance, ListValue, MapValue)):
                    frame.variables[param.name] = self._by_value(value, param, frame)
        return frame

    def _by_value(self, value: Value, param: Param, frame: Frame) -> Value:
        """Return what a parameter without & and * holds: a copy."""
        if isinstance(value, Instance) and isinstance(value.type, ClassValue) and param.type:
            return copied(value) if self.class_of(param.type, frame) is value.type else value
        return container_copied(value)


def container_copied(value: Value) -> Value:
    """Return a list or map as a new one with the same items, any other value as it is."""
    if isinstance(value, ListValue):
        return ListValue(dict(value.fields), value.kind)
    return replace(value, fields=dict(value.fields)) if isinstance(value, MapValue) else value


def _given(called: FunctionValue, arguments: Arguments) -> Arguments:
    """Return the arguments, what boost::bind gave put in their places."""
    if not called.given:
        return arguments
    left = list(arguments.values)
    values = [
        (left.pop(0) if left else Hole("?")) if isinstance(value, Placeholder) else value
        for value in called.given
    ]
    return Arguments(values=(*values, *left), line=arguments.line, frame=arguments.frame)

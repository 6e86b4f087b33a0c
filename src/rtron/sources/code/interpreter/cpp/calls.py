"""Calls of C++ functions: the frame that one runs in."""

from dataclasses import dataclass, field, replace

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.cpp.braces import construct_braced, is_braces
from rtron.sources.code.interpreter.cpp.types import CppTypes
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments, bind_parameters
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.library_models.common.containers import copy_instance


@dataclass(eq=False, slots=True, kw_only=True)
class CppCalls(CppTypes):
    """The calls of one program."""

    machine: AbstractMachine = field(init=False)

    def call_frame(self, called: av.FunctionValue, arguments: Arguments) -> StackFrame:
        """Return the frame of a call: parameters bound, references to the caller's slots."""
        function = called.function
        passed = _with_bound_arguments(called, arguments)
        outer = called.closure
        frame = StackFrame(
            file=function.file,
            function=function,
            closure=outer if isinstance(outer, StackFrame) else None,
            this=called.owner if called.owner is not None else getattr(outer, "this", None),
            cls=called.cls,
            scope=getattr(outer, "scope", "") or self._scope_of(function),
            types=self.bind_template_parameters(called, passed),
            caller=arguments,
            constants={param.name: param.constant for param in function.params},
        )

        def default(node: ir.Expr) -> av.Value:
            types = frame.types
            around = StackFrame(file=function.file, scope=frame.scope, this=frame.this, types=types)
            return self.machine.evaluate(node, around)

        frame.variables = bind_parameters(function.params, passed, default)
        for at, param in enumerate(function.params):
            slot = passed.slot(at)
            is_alias = param.reference and slot is not None and slot.key != "this"
            if is_alias and slot is not None and param.kind == "plain":
                frame.aliases[param.name] = slot
            elif param.kind == "plain":
                value = frame.variables[param.name]
                if param.reference and not is_braces(value):
                    continue
                if isinstance(value, (av.Instance, av.ListValue, av.MapValue)):
                    frame.variables[param.name] = self._copy_argument(value, param, frame)
        return frame

    def _scope_of(self, function: ir.Function) -> str:
        """Return the scope of a function's names: its own, if it has classes of its own."""
        name = function.name
        return name if name in self.symbols.local_scopes else name.rpartition("::")[0]

    def _copy_argument(self, value: av.Value, param: ir.Param, frame: StackFrame) -> av.Value:
        """Return what a parameter without & and * holds: a copy, or what braces make."""
        if isinstance(value, av.Instance) and isinstance(value.type, av.ClassValue) and param.type:
            return copy_instance(value) if self.class_of(param.type, frame) is value.type else value
        if is_braces(value):
            at = Arguments(line=frame.caller.line, frame=frame)
            value = construct_braced(self.machine, param.type, value, at)
        return copy_container(value)


def copy_container(value: av.Value) -> av.Value:
    """Return a list or map as a new one with the same items, any other value as it is."""
    if isinstance(value, av.ListValue):
        return replace(value, fields=dict(value.fields))
    return replace(value, fields=dict(value.fields)) if isinstance(value, av.MapValue) else value


def _with_bound_arguments(called: av.FunctionValue, arguments: Arguments) -> Arguments:
    """Return the arguments with those that boost::bind gave."""
    if not called.bound_arguments:
        return arguments
    left = list(arguments.values)
    values = [
        (left.pop(0) if left else av.UNKNOWN) if isinstance(value, av.BindPlaceholder) else value
        for value in called.bound_arguments
    ]
    return arguments.with_values(*values, *left)

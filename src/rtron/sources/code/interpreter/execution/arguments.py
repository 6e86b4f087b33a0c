"""What a call passes, as library models see it."""

from collections.abc import Callable, Mapping
from dataclasses import field
from typing import Any

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame, StorageSlot
from rtron.sources.code.record import record
from rtron.vocabulary import Evidence


@record(frozen=True, slots=True, kw_only=True)
class Arguments:
    """The values of a call, and the slots of those that have one, to be written to by C++.

    `types` are the template arguments, `frame` is the caller's. `addresses` are the positions of
    `&x`.
    """

    values: tuple[av.Value, ...] = ()
    keywords: Mapping[str, av.Value] = field(default_factory=dict)
    slots: tuple[StorageSlot | None, ...] = ()
    types: tuple[ir.TypeRef, ...] = ()
    line: int = 0
    frame: StackFrame
    addresses: tuple[int, ...] = ()

    @property
    def evidence(self) -> Evidence:
        """Where the call stands."""
        return Evidence(file=self.frame.file, line=self.line)

    @property
    def all_values(self) -> tuple[av.Value, ...]:
        """The positional arguments and those by name."""
        return (*self.values, *self.keywords.values())

    def get(self, index: int, keyword: str = "") -> av.Value | None:
        """Return the argument of a position or name, None where it is not given."""
        if index < len(self.values):
            return self.values[index]
        return self.keywords.get(keyword) if keyword else None

    def value(self, index: int, keyword: str = "") -> av.Value:
        """Return the argument of a position or name, an unknown value where it is not given."""
        return self.get(index, keyword) or av.UNKNOWN

    def slot(self, index: int) -> StorageSlot | None:
        """Return where the argument of a position is kept."""
        return self.slots[index] if index < len(self.slots) else None

    def with_values(self, *values: av.Value) -> "Arguments":
        """Return other positional arguments of the same call, without slots and types."""
        return Arguments(values=values, line=self.line, frame=self.frame)

    def without_first(self, count: int) -> "Arguments":
        """Return the arguments behind the first `count`."""
        return Arguments(
            values=self.values[count:],
            keywords=self.keywords,
            slots=self.slots[count:],
            types=self.types,
            line=self.line,
            frame=self.frame,
        )


LibraryCall = Callable[..., av.Value]
OPEN_KEYWORD = "**"
"""The name of an argument that says that others may be given which are not known."""


def bind_parameters(
    params: tuple[ir.Param, ...], arguments: Arguments, default: Callable[[ir.Expr], av.Value]
) -> dict[str, av.Value]:
    """Return the variables a call begins with; a missing argument is an Unknown of its name."""
    variables: dict[str, av.Value] = {}
    position = 0
    for param in params:
        if param.kind == "star":
            variables[param.name] = av.list_of(arguments.values[position:], "tuple")
            position = len(arguments.values)
        elif param.kind == "stars":
            named = {p.name for p in params} | {OPEN_KEYWORD}
            rest: dict[Any, av.Value] = {
                k: v for k, v in arguments.keywords.items() if k not in named
            }
            if OPEN_KEYWORD in arguments.keywords:
                rest[av.OPEN] = arguments.keywords[OPEN_KEYWORD]
            variables[param.name] = av.MapValue(rest)
        else:
            index = position if param.kind == "plain" else len(arguments.values)
            variables[param.name] = _parameter_value(param, index, arguments, default)
            position += param.kind == "plain"
    return variables


def evaluate_defaults(
    function: ir.Function, default: Callable[[ir.Expr], av.Value]
) -> dict[str, av.Value]:
    """Return the defaults that Python evaluates where it meets the definition."""
    return {
        param.name: default(param.default)
        for param in function.params
        if param.default is not None and not isinstance(param.default, ir.Const)
    }


def _parameter_value(
    param: ir.Param, position: int, arguments: Arguments, default: Callable[[ir.Expr], av.Value]
) -> av.Value:
    given = arguments.get(position, param.name)
    if given is not None:
        return given
    if OPEN_KEYWORD in arguments.keywords:
        return av.Unknown(param.name, type=param.type)
    if param.default is not None:
        return default(param.default)
    return av.Unknown(param.name, type=param.type)

"""std::optional, std::variant and std::any: what they hold is made in place (cppreference.com)."""

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.language_runtime import cpp_runtime
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.ir.references import ir_nodes

PLACE_TAGS = frozenset({"std::in_place", "std::in_place_type", "std::in_place_index"})
_HOLDERS = frozenset({"std::optional", "std::variant", "std::any", "boost::optional"})
_TAG = av.LibraryClass("std::in_place")


def place_tag(types: tuple[ir.TypeRef, ...]) -> av.Instance:
    """Return what `std::in_place_type<T>` and its kin are: a mark with the type."""
    return av.Instance(_TAG, {}, types)


def construct_in_place(machine: AbstractMachine, arguments: Arguments) -> av.Value | None:
    """Make what `std::variant<…>{std::in_place_type<T>, args…}` holds; None without such a mark."""
    tag = arguments.get(0)
    if not (isinstance(tag, av.Instance) and tag.type is _TAG):
        return None
    type = _chosen_type(tag.types, arguments.types)
    given = arguments.without_first(1)
    return cpp_runtime(machine).construct(type, given) if type else av.Unknown("held")


def emplace(machine: AbstractMachine, node: ir.Call, frame: StackFrame) -> av.Value:
    """Make what `held.emplace(args…)` of a std::optional holds, `emplace<T>(…)` of a variant."""
    values = tuple(machine.evaluate(arg, frame) for arg in node.args)
    function = node.function
    holder = _holder_type(machine, function.owner, frame) if isinstance(function, ir.Attr) else None
    written = function.types if isinstance(function, ir.Attr) else ()
    type = _chosen_type(written, holder.args if holder else ())
    given = Arguments(values=values, line=node.line, frame=frame)
    made = (
        cpp_runtime(machine).construct(type, given) if type is not None else av.Unknown("emplace")
    )
    return values[0] if isinstance(made, av.Unknown) and len(values) == 1 else made


def _chosen_type(
    written: tuple[ir.TypeRef, ...], held: tuple[ir.TypeRef, ...]
) -> ir.TypeRef | None:
    """Return the type that is written, itself or by its number, else the first that is held."""
    if not written:
        return held[0] if held else None
    if not written[0].name.isdigit():
        return written[0]
    at = int(written[0].name)
    return held[at] if at < len(held) else None


def _holder_type(machine: AbstractMachine, holder: ir.Expr, frame: StackFrame) -> ir.TypeRef | None:
    """Return the type that a std::optional or the like is declared with, in names known here."""
    declared = None
    if isinstance(holder, ir.Name):
        declared = _local(holder.id, frame) or _member(machine, frame.this, holder.id)
    elif isinstance(holder, ir.Attr):
        declared = _member(machine, machine.evaluate(holder.owner, frame), holder.name)
    if declared is None or declared.type is None:
        return None
    found = cpp_runtime(machine).resolve_type(declared.type, frame)
    return found if found.name in _HOLDERS else None


def _local(name: str, frame: StackFrame) -> ir.Declare | None:
    body = frame.function.body if frame.function else None
    found = (node for node in ir_nodes(body) if isinstance(node, ir.Declare) and node.name == name)
    return next(found, None)


def _member(machine: AbstractMachine, owner: av.Value | None, name: str) -> ir.Declare | None:
    lineage = machine.runtime.lineage(owner.type) if isinstance(owner, av.Instance) else ()
    classes = (each.definition for each in lineage if isinstance(each, av.ClassValue))
    found = (member for cls in classes for member in cls.fields if member.name == name)
    return next(found, None)

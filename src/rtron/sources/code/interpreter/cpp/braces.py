"""What `{…}` of C++ makes, by the type of what it is for (C++17, clause 11.6.4)."""

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.assignment import slot_of
from rtron.sources.code.interpreter.execution.language_runtime import cpp_runtime
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame


def is_braces(value: av.Value | None) -> bool:
    """Tell whether a value is what stands in braces: a list, or members by their names."""
    if isinstance(value, av.ListValue):
        return value.kind == ir.BRACES
    return isinstance(value, av.MapValue) and not value.iterates_pairs


def construct_braced(
    machine: AbstractMachine, type: ir.TypeRef | None, value: av.Value, at: Arguments
) -> av.Value:
    """Return an object of a type, made of what stands in braces; of an unknown type, that itself.

    A container takes it as one list, as a constructor with a std::initializer_list does.
    """
    runtime = cpp_runtime(machine)
    found = runtime.class_of(type, at.frame) if type is not None else None
    if type is None or found is None or not is_braces(value):
        return value
    if isinstance(found, av.LibraryClass):
        takes_all = found.takes_list or not isinstance(value, av.ListValue)
        given = (value,) if takes_all else _items(value)
        return runtime.construct(type, at.with_values(*given)) if found.construct else value
    takes_all = not isinstance(value, av.ListValue) or runtime.takes_initialiser_list(found)
    given = (value,) if takes_all and _items(value) else _items(value)
    return runtime.construct(type, at.with_values(*given))


def _items(value: av.Value) -> tuple[av.Value, ...]:
    return value.items if isinstance(value, av.ListValue) else (value,)


def type_of_target(
    machine: AbstractMachine, target: ir.Expr, frame: StackFrame
) -> ir.TypeRef | None:
    """Return the type of what is assigned to, as far as what it holds says it."""
    if isinstance(target, ir.Index):
        return item_type(machine.evaluate(target.owner, frame))
    slot = slot_of(machine, target, frame)
    held = slot.holder.get(slot.key) if slot is not None else None
    if isinstance(held, av.Instance) and isinstance(held.type, av.ClassValue):
        return ir.TypeRef(held.type.name, held.types)
    return held.type if isinstance(held, (av.ListValue, av.MapValue, av.Unknown)) else None


def item_type(container: av.Value) -> ir.TypeRef | None:
    """Return the type of a container's items, of a map's values."""
    at = int(isinstance(container, av.MapValue))
    type = container.type if isinstance(container, (av.ListValue, av.MapValue)) else None
    return type.args[at] if type is not None and len(type.args) > at else None


def make_item(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """Return the item that a container makes of arguments: `emplace_back(a, b)`.

    What is one already stays what it is.
    """
    given, type = arguments.get(0) or av.NONE, item_type(owner)
    if type is None:
        return given
    if len(arguments.values) == 1 and is_braces(given):
        return construct_braced(machine, type, given, arguments)
    runtime = cpp_runtime(machine)
    found = runtime.class_of(type, arguments.frame)
    if found is None or (len(arguments.values) == 1 and not _needs_making(machine, found, given)):
        return given
    made = runtime.construct(type, arguments)
    return given if isinstance(made, av.Unknown) else made


def default_item(machine: AbstractMachine, owner: av.Value, frame: StackFrame) -> av.Value:
    """Return what a container's items are by default, an object of its own for each."""
    type = item_type(owner)
    return av.Unknown("item") if type is None else cpp_runtime(machine).default_value(type, frame)


def _needs_making(
    machine: AbstractMachine, cls: av.ClassValue | av.LibraryClass, given: av.Value
) -> bool:
    """Tell whether one argument is a constructor's, not an object of the class itself."""
    if isinstance(cls, av.LibraryClass):
        return isinstance(given, av.FunctionValue)
    if isinstance(given, (av.Unknown, av.ClassValue)) or given == av.NONE:
        return False
    return not (isinstance(given, av.Instance) and cls in machine.runtime.lineage(given.type))

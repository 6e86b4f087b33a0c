"""Iterators of C++ containers: `for (it = xs.begin(); it != xs.end(); ++it)`."""

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments

_END, _CONTAINER = "end", "owner"


def begin(_: AbstractMachine, owner: av.Value, __: Arguments) -> av.Value:
    """`container.begin()`."""
    items, certain = av.items_of(owner)
    holder = av.Instance(av.LibraryClass("items"), {**dict(enumerate(items)), _CONTAINER: owner})
    return _iterator_at(holder, 0, len(items), certain=certain)


def iterator_to(
    machine: AbstractMachine, owner: av.Value, position: int, at: Arguments
) -> av.Value:
    """Return an iterator at one of a container's items."""
    first = begin(machine, owner, at)
    found = items_after(first)
    return found[0][position][0] if found is not None and position < len(found[0]) else first


def items_after(value: av.Value | None) -> tuple[list[tuple[av.Instance, av.Value]], bool] | None:
    """Return the iterators from one on with their items, and whether these are all."""
    if not isinstance(value, av.Instance) or value.type is not ITERATOR or _END in value.fields:
        return None
    items, position, count = (value.fields[name] for name in ("items", "at", "count"))
    if not (
        isinstance(items, av.Instance)
        and isinstance(position, av.Scalar)
        and isinstance(count, av.Scalar)
    ):
        return None
    certain = value.fields["certain"] == av.Scalar(value=True)
    positions = range(position.value, count.value)
    found = [_iterator_at(items, at, count.value, certain=certain) for at in positions]
    return [(one, dereference(one)) for one in found], certain


def write_through(machine: AbstractMachine, held: av.Value | None, value: av.Value) -> bool:
    """Do `*it = value`: a variable that holds an iterator can get nothing but iterators itself."""
    if not isinstance(held, av.Instance) or held.type is not ITERATOR or _END in held.fields:
        return False
    if isinstance(value, (av.Unknown, av.Choice)) or getattr(value, "type", None) is ITERATOR:
        return False
    items, position = held.fields["items"], held.fields["at"]
    if isinstance(items, av.Instance) and isinstance(position, av.Scalar):
        machine.undo_log.set(items.fields, position.value, value)
        owner = items.fields[_CONTAINER]
        if isinstance(owner, av.ListValue) and position.value < len(owner.items):
            changed = (*owner.items[: position.value], value, *owner.items[position.value + 1 :])
            machine.undo_log.set(owner.fields, "items", changed)
    return True


def end(_: AbstractMachine, __: av.Value, ___: Arguments) -> av.Value:
    """`container.end()`."""
    return av.Instance(ITERATOR, {_END: av.Scalar(value=True)})


def container_of(value: av.Value | None) -> av.Value | None:
    """Return what an iterator goes through, any other value as it is."""
    if not isinstance(value, av.Instance) or value.type is not ITERATOR or _END in value.fields:
        return value
    items = value.fields["items"]
    return items.fields[_CONTAINER] if isinstance(items, av.Instance) else value


def position_of(value: av.Value | None) -> int:
    """Return how many items stand before an iterator; none where that is not known."""
    position = value.fields.get("at") if isinstance(value, av.Instance) else None
    return position.value if isinstance(position, av.Scalar) else 0


def is_end(value: av.Value) -> bool:
    """Tell whether a value is what `container.end()` gives."""
    return isinstance(value, av.Instance) and value.type is ITERATOR and _END in value.fields


def dereference(value: av.Value) -> av.Value:
    """Return what an iterator points at; any other value is itself."""
    if not isinstance(value, av.Instance) or value.type is not ITERATOR or _END in value.fields:
        return value
    items, position = value.fields["items"], value.fields["at"]
    if isinstance(items, av.Instance) and isinstance(position, av.Scalar):
        return items.fields.get(position.value) or av.Unknown("item")
    return av.Unknown("item")


def _iterator_at(items: av.Instance, position: int, count: int, *, certain: bool) -> av.Instance:
    return av.Instance(
        ITERATOR,
        {
            "items": items,
            "at": av.Scalar(position),
            "count": av.Scalar(count),
            "certain": av.Scalar(certain),
        },
    )


def _advance(_: AbstractMachine, owner: av.Instance, __: Arguments) -> av.Value:
    items, position, count = (owner.fields.get(name) for name in ("items", "at", "count"))
    if not (
        isinstance(items, av.Instance)
        and isinstance(position, av.Scalar)
        and isinstance(count, av.Scalar)
    ):
        return av.Unknown("iterator")
    certain = owner.fields["certain"] == av.Scalar(value=True)
    return _iterator_at(items, position.value + 1, count.value, certain=certain)


def _not_equal(_: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    other = arguments.get(0)
    is_end = isinstance(other, av.Instance) and _END in other.fields
    if is_end and _END in owner.fields:
        return av.Scalar(value=False)
    if not is_end or _END in owner.fields:
        return av.Unknown("iterator")
    position, count = owner.fields["at"], owner.fields["count"]
    inside = (
        isinstance(position, av.Scalar)
        and isinstance(count, av.Scalar)
        and position.value < count.value
    )
    if inside or owner.fields["certain"] == av.Scalar(value=True):
        return av.Scalar(inside)
    return av.Unknown("iterator")


def _equal(machine: AbstractMachine, owner: av.Instance, arguments: Arguments) -> av.Value:
    answer = _not_equal(machine, owner, arguments)
    return av.Scalar(not answer.value) if isinstance(answer, av.Scalar) else answer


ITERATOR = av.LibraryClass(
    "iterator",
    methods={
        "operator+": _advance,
        "operator!=": _not_equal,
        "operator==": _equal,
        "operator<": _not_equal,
    },
)

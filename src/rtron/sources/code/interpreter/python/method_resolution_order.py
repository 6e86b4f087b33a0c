"""The order in which Python looks for a member in a class and its bases.

It is C3, as "The Python 2.3 Method Resolution Order" (docs.python.org: howto/mro) describes it.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from rtron.sources.code.interpreter import abstract_values as av

MAX_CLASSES = 32
_Order = tuple[av.Value, ...]
SUPER = av.LibraryClass("super")


@dataclass(eq=False, slots=True)
class MethodResolutionOrders:
    """The orders of the classes of one program, each worked out once.

    `refused` are those whose bases contradict each other: Python does not make such a class.
    """

    refused: set[av.ClassValue] = field(default_factory=set)
    _orders: dict[av.ClassValue, _Order] = field(default_factory=dict)

    def order_of(self, cls: av.Value, depth: int = 0) -> _Order:
        """Return a class and its bases, as many as count; nearest first where C3 refuses."""
        if not isinstance(cls, av.ClassValue) or depth > MAX_CLASSES:
            return (cls,)
        if cls not in self._orders:
            self._orders[cls] = self._linearise(cls, depth)
        return self._orders[cls]

    def _linearise(self, cls: av.ClassValue, depth: int) -> _Order:
        bases = _bases(cls)
        merged = _merge([*(self.order_of(base, depth + 1) for base in bases), bases])
        if merged is None:
            self.refused.add(cls)
            return _nearest_first(cls)
        return (cls, *merged)[:MAX_CLASSES]


def super_object(
    owner: av.Instance | av.ClassValue, cls: av.ClassValue, order: _Order
) -> av.Instance:
    """Return what `super()` is in a method of a class: the object, as the classes behind see it."""
    following = order[order.index(cls) + 1 :]
    return av.Instance(SUPER, {"owner": owner, "behind": av.list_of(following, "tuple")})


def _bases(cls: av.ClassValue) -> _Order:
    return tuple(option for base in cls.bases for option in av.options(base))[:MAX_CLASSES]


def _merge(orders: list[_Order]) -> _Order | None:
    """Merge orders so that each is kept; None where they contradict each other."""
    merged: list[av.Value] = []
    left = [order for order in orders if order]
    while left and len(merged) < MAX_CLASSES:
        head = next((order[0] for order in left if not _is_in_tail(order[0], left)), None)
        if head is None:
            return None
        merged.append(head)
        left = list(_without(head, left))
    return tuple(merged)


def _is_in_tail(cls: av.Value, orders: list[_Order]) -> bool:
    return any(cls in order[1:] for order in orders)


def _without(head: av.Value, orders: Iterable[_Order]) -> Iterator[_Order]:
    rests = (order[1:] if order[0] == head else order for order in orders)
    return (rest for rest in rests if rest)


def _nearest_first(cls: av.Value) -> _Order:
    queue, found = [cls], list[av.Value]()
    while queue and len(found) < MAX_CLASSES:
        current = queue.pop(0)
        if current not in found:
            found.append(current)
            queue.extend(_bases(current) if isinstance(current, av.ClassValue) else ())
    return tuple(found)

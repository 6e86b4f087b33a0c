"""The messages that wait: the next one first, and the oldest one first."""

from collections import OrderedDict
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from heapq import heapify, heappop, heappush
from itertools import count

from rtron.vocabulary import Flow

_PINNED_RANK = float("-inf")
_SPARE_ENTRIES = 16


@dataclass(slots=True, eq=False)
class HeldMessage:
    """A message that waits since `arrived_at` (ns), the arrival of its freshest content."""

    flow: Flow
    message: object
    arrived_at: int


def message_size(message: object) -> int:
    """Return how many bytes a message has, 0 if it is no bytes."""
    return len(message) if isinstance(message, bytes) else 0


class HeldMessageQueue:
    """Held messages in the order of `rank` (least first), then of arrival.

    Each operation takes O(log n) amortised: what was removed stays in the heap until it comes to
    the top, or until it makes up half of the heap.
    """

    __slots__ = ("_by_age", "_heap", "_latest", "_number", "_rank", "size")

    def __init__(self, rank: Callable[[Flow], int]) -> None:
        self.size = 0
        """How many bytes wait."""
        self._rank = rank
        self._number = count()
        self._heap: list[tuple[float, int, HeldMessage]] = []
        self._by_age: OrderedDict[HeldMessage, None] = OrderedDict()
        self._latest: dict[str, HeldMessage] = {}

    def __len__(self) -> int:
        return len(self._by_age)

    def add(self, flow: Flow, message: object, now: int) -> None:
        """Hold a message that arrived at `now`."""
        held = HeldMessage(flow, message, now)
        self.size += message_size(message)
        self._by_age[held] = None
        self._latest[flow.name] = held
        heappush(self._heap, (self._rank(flow), next(self._number), held))

    def replace_message(self, held: HeldMessage, message: object, now: int) -> None:
        """Put a newer message of the same flow in the place of an older one."""
        self.size += message_size(message) - message_size(held.message)
        held.message = message
        held.arrived_at = now
        self._by_age.move_to_end(held)

    def latest(self, flow: str) -> HeldMessage | None:
        """Return the message of `flow` that arrived last, if it still waits."""
        return self._latest.get(flow)

    def find(self, message: object) -> HeldMessage | None:
        """Return what holds this very object."""
        return next((held for held in self._by_age if held.message is message), None)

    def first(self) -> HeldMessage | None:
        """Return the message that goes next."""
        heap = self._heap
        while heap:
            held = heap[0][2]
            if held in self._by_age:
                return held
            heappop(heap)
        return None

    def pin_first(self) -> None:
        """Settle that the one which goes next now will go next whatever arrives."""
        if self.first():
            _, number, held = self._heap[0]
            self._heap[0] = (_PINNED_RANK, number, held)

    def oldest(self) -> HeldMessage | None:
        """Return the message that arrived first."""
        return next(iter(self._by_age), None)

    def messages(self) -> tuple[HeldMessage, ...]:
        """Return every message that waits, in the order in which the places were taken."""
        placed = sorted(self._heap, key=lambda entry: entry[1])
        return tuple(held for _, _, held in placed if held in self._by_age)

    def load(self, others: Iterable[HeldMessage]) -> None:
        """Hold messages that waited elsewhere, in the order of their places; none waits yet."""
        for held in others:
            self.add(held.flow, held.message, held.arrived_at)
        by_age = sorted(self._by_age, key=lambda held: held.arrived_at)
        self._by_age = OrderedDict.fromkeys(by_age)

    def remove(self, held: HeldMessage) -> None:
        """Let a message leave."""
        del self._by_age[held]
        self.size -= message_size(held.message)
        if self._latest.get(held.flow.name) is held:
            del self._latest[held.flow.name]
        if len(self._heap) > 2 * len(self._by_age) + _SPARE_ENTRIES:
            self._heap = [entry for entry in self._heap if entry[2] in self._by_age]
            heapify(self._heap)

"""Who has spoken lately, and which of them has the highest priority."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from heapq import heappop, heappush

from rtron.vocabulary import Flow


@dataclass(slots=True, eq=False)
class Speaker:
    """A flow that may speak: fresh after each message for `limit` ns, until `lapses`.

    `listed` tells whether it stands in the heap; one that never spoke does not.
    """

    flow: Flow
    limit: int
    lapses: int = 0
    listed: bool = False


class Speakers:
    """The fresh flows in a heap by priority; who fell silent is removed when it comes to the top.

    A flow stands in the heap at most once, so a message costs O(log flows) amortised, and O(1)
    while the same flows keep speaking. Priorities must differ.
    """

    __slots__ = ("_heap", "named")

    def __init__(self, flows: Iterable[Flow], limit: Callable[[Flow], int]) -> None:
        self.named = {flow.name: Speaker(flow, limit(flow)) for flow in flows}
        self._heap: list[tuple[int, Speaker]] = []

    def hear(self, speaker: Speaker, now: int) -> None:
        """Note that `speaker` spoke at `now`."""
        speaker.lapses = now + speaker.limit
        if not speaker.listed:
            speaker.listed = True
            heappush(self._heap, (-speaker.flow.priority, speaker))

    def spoke(self, now: int) -> dict[str, int]:
        """Return when each fresh flow spoke last."""
        named = self.named.items()
        return {name: each.lapses - each.limit for name, each in named if now < each.lapses}

    def resume(self, spoke: Mapping[str, int]) -> None:
        """Take over who spoke when, of the flows that may speak here."""
        for name, at in spoke.items():
            if name in self.named:
                self.hear(self.named[name], at)

    def highest(self, now: int) -> Speaker | None:
        """Return the fresh flow of highest priority."""
        heap = self._heap
        while heap:
            speaker = heap[0][1]
            if now < speaker.lapses:
                return speaker
            heappop(heap)
            speaker.listed = False
        return None

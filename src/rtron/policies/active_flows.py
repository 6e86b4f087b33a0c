"""Who has spoken lately, and which of them has the highest priority."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from heapq import heappop, heappush

from rtron.vocabulary import Flow


@dataclass(slots=True, eq=False)
class FlowActivity:
    """A flow that may speak: fresh after each message for `timeout` ns, until `expires_at`.

    `in_heap` tells whether it stands in the heap; one that never spoke does not.
    """

    flow: Flow
    timeout: int
    expires_at: int = 0
    in_heap: bool = False


class ActiveFlows:
    """The fresh flows in a heap by priority; who fell silent is removed when it comes to the top.

    A flow stands in the heap at most once, so a message costs O(log flows) amortised, and O(1)
    while the same flows keep speaking. Priorities must differ.
    """

    __slots__ = ("_heap", "by_name")

    def __init__(self, flows: Iterable[Flow], timeout: Callable[[Flow], int]) -> None:
        self.by_name = {flow.name: FlowActivity(flow, timeout(flow)) for flow in flows}
        self._heap: list[tuple[int, FlowActivity]] = []

    def record_message(self, activity: FlowActivity, now: int) -> None:
        """Note that `activity` spoke at `now`."""
        activity.expires_at = now + activity.timeout
        if not activity.in_heap:
            activity.in_heap = True
            heappush(self._heap, (-activity.flow.priority, activity))

    def forget(self, name: str, now: int) -> None:
        """Take a flow for silent from `now` on."""
        activity = self.by_name.get(name)
        if activity:
            activity.expires_at = min(activity.expires_at, now)

    def last_message_times(self, now: int) -> dict[str, int]:
        """Return when each fresh flow spoke last."""
        activities = self.by_name.items()
        return {
            name: each.expires_at - each.timeout
            for name, each in activities
            if now < each.expires_at
        }

    def restore(self, last_message_times: Mapping[str, int]) -> None:
        """Take over who spoke when, of the flows that may speak here."""
        for name, at in last_message_times.items():
            if name in self.by_name:
                self.record_message(self.by_name[name], at)

    def highest_priority(self, now: int) -> FlowActivity | None:
        """Return the fresh flow of highest priority."""
        heap = self._heap
        while heap:
            activity = heap[0][1]
            if now < activity.expires_at:
                return activity
            heappop(heap)
            activity.in_heap = False
        return None

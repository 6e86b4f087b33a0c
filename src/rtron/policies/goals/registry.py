"""The goals of one action that are not over: whose they are, where they are, who may cancel them.

Sans-I/O. A goal id is chosen by its client and known to everybody, so it proves nothing: a goal
belongs to the client that brought it first, and only that client may cancel it. Bounded in number;
what is over is remembered for a while, since a goal must not run twice.
"""

from collections import Counter, OrderedDict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from hashlib import blake2b
from typing import Any, Generic, TypeVar

from rtron.vocabulary import SECOND

MAX_GOALS = 1024
"""The most goals of clients that may not be over; the guard refuses more."""
MAX_UNOWNED_GOALS = 64
"""The most goals without a client that are known."""
MAX_ID_LENGTH = 1024
MAX_FINISHED_GOALS = 4096
ID_REUSE_DELAY = 5 * SECOND
"""A client may use an id again so long after its goal was over, as with actionlib's own server."""
_MAX_EARLY_CANCELS = 64
_MAX_CANCEL_STAMPS = 256
_MAX_SNAPSHOT_ENTRIES = 256
_MAX_SNAPSHOT_BYTES = 1 << 16

K = TypeVar("K")
V = TypeVar("V")


class GoalStage(Enum):
    """Where a goal is."""

    WAITING = "with the guard"
    SENT = "with the server"


@dataclass(slots=True, eq=False)
class Goal:
    """A goal, whose it is, and since when it is where it is (ns).

    `status` is what the server last said of it (actionlib_msgs/GoalStatus), and `last_seen` when.
    `is_unread` until the server has said anything of it, or has gone, after the guard sent it.
    `cancel_reason` says why the guard cancelled it. A goal of the server's own, or one that is
    older than the guard, has no client.
    """

    id: bytes
    stamp: int
    flow: str
    client: str
    message: bytes = b""
    stage: GoalStage = GoalStage.WAITING
    last_seen: int = 0
    status: int = 0
    is_unread: bool = False
    cancel_reason: str = ""


@dataclass(frozen=True, slots=True)
class _FinishedGoal:
    """A goal that is over: whose it was and until when its id may not be used again (ns)."""

    client: str
    reusable_at: int


class _NewestEntries(Generic[K, V]):
    """The entries that were set last, `most` of them."""

    def __init__(self, size: int) -> None:
        self._size = size
        self._entries: OrderedDict[K, V] = OrderedDict()

    def __contains__(self, key: K) -> bool:
        return key in self._entries

    def set(self, key: K, value: V) -> None:
        self._entries.pop(key, None)
        self._entries[key] = value
        if len(self._entries) > self._size:
            self._entries.popitem(last=False)

    def get(self, key: K) -> V | None:
        return self._entries.get(key)

    def pop(self, key: K) -> V | None:
        return self._entries.pop(key, None)

    def last(self, count: int) -> list[tuple[K, V]]:
        return list(self._entries.items())[-count:]


class GoalRegistry:
    """Who owns which goal of an action."""

    def __init__(self) -> None:
        self._goals: OrderedDict[bytes, Goal] = OrderedDict()
        self._waiting: Counter[str] = Counter()
        self.newest_stamp = 0
        self._finished: _NewestEntries[str, _FinishedGoal] = _NewestEntries(MAX_FINISHED_GOALS)
        self._early_cancels: _NewestEntries[tuple[str, bytes], int] = _NewestEntries(
            _MAX_EARLY_CANCELS
        )
        self._cancelled_until: _NewestEntries[str, int] = _NewestEntries(_MAX_CANCEL_STAMPS)

    def __iter__(self) -> Iterator[Goal]:
        return iter(tuple(self._goals.values()))

    def __len__(self) -> int:
        return len(self._goals)

    def find(self, id: bytes) -> Goal | None:
        """Return the goal that is called so and is not over."""
        return self._goals.get(id)

    def rejection_reason(self, id: bytes, client: str, now: int) -> str:
        """Return why a goal of `client` may not be called `id`, or nothing."""
        if len(id) > MAX_ID_LENGTH:
            return f"a goal id of {len(id)} bytes, the most is {MAX_ID_LENGTH}"
        if id in self._goals:
            return "another goal has this id"
        if len(client) > MAX_ID_LENGTH:
            return f"a client's name of {len(client)} letters"
        finished = self._finished.get(_digest(id))
        if finished and (finished.client != client or now < finished.reusable_at):
            return "a goal that is over had this id"
        unowned = 0 if client else sum(not goal.client for goal in self)
        return f"{MAX_UNOWNED_GOALS} goals have no client" if unowned >= MAX_UNOWNED_GOALS else ""

    def add(self, goal: Goal) -> None:
        """Take a goal, of which `rejection_reason` said nothing."""
        self._goals[goal.id] = goal
        self._waiting[goal.flow] += goal.stage is GoalStage.WAITING

    def waiting_count(self, flow: str) -> int:
        """Return how many goals of a flow wait."""
        return self._waiting[flow]

    def mark_sent(self, goal: Goal, now: int) -> None:
        """Know that a goal is with the server."""
        self._waiting[goal.flow] -= goal.stage is GoalStage.WAITING
        goal.stage, goal.last_seen, goal.is_unread = GoalStage.SENT, now, True

    def forget_unread(self) -> None:
        """Know that the server is gone, and with it what it had not read."""
        for goal in self:
            goal.is_unread = False

    def finish(self, goal: Goal, now: int) -> None:
        """Forget a goal that is over, but for its id."""
        if self._goals.pop(goal.id, None):
            self._waiting[goal.flow] -= goal.stage is GoalStage.WAITING
            self.remember_finished(goal.id, goal.client, now)

    def remember_finished(self, id: bytes, client: str, now: int) -> None:
        """Know that a goal is over."""
        self._finished.set(_digest(id), _FinishedGoal(client, now + ID_REUSE_DELAY))

    def is_finished(self, id: bytes) -> bool:
        """Tell whether a goal is known to be over."""
        return _digest(id) in self._finished

    def cancel_targets(self, client: str, id: bytes, stamp: int, now: int) -> list[Goal]:
        """Return the goals that a cancel of `client` means, all of them its own.

        As in actionlib: an id, or with a stamp all goals up to then, or with neither all goals.
        What is meant and has not come yet is noted; see `was_cancelled_early`.
        """
        if stamp:
            self._cancelled_until.set(client, max(stamp, self._cancelled_until.get(client) or 0))
        if id and id not in self._goals:
            self._early_cancels.set((client, id), now)
        everything = not id and not stamp
        client_goals = (goal for goal in self if goal.client == client)
        return [
            g for g in client_goals if everything or g.id == id or (stamp and 0 < g.stamp <= stamp)
        ]

    def was_cancelled_early(self, goal: Goal, now: int) -> bool:
        """Tell whether a goal that comes now was cancelled before it came."""
        noted = self._early_cancels.pop((goal.client, goal.id))
        by_id = noted is not None and now - noted < ID_REUSE_DELAY
        return by_id or 0 < goal.stamp <= (self._cancelled_until.get(goal.client) or 0)

    def monotonic_stamp(self, stamp: int) -> int:
        """Return the stamp that a goal of `stamp` goes with: none is older than the one before.

        SimpleActionServers refuse a goal that is older than their last.
        """
        self.newest_stamp = max(self.newest_stamp, stamp)
        return self.newest_stamp

    def snapshot(self) -> Mapping[str, Any]:
        """Return what a successor of this guard must know, as JSON of at most 128 KiB."""
        goals = (
            [g.id.hex(), g.stamp, g.flow, g.client, g.stage is GoalStage.SENT]
            for g in self._round_robin()
        )
        finished = (
            [digest, entry.client]
            for digest, entry in reversed(self._finished.last(_MAX_SNAPSHOT_ENTRIES))
        )
        return {
            "goals": _fit_into_bytes(_MAX_SNAPSHOT_BYTES, goals),
            "over": _fit_into_bytes(_MAX_SNAPSHOT_BYTES, finished)[::-1],
            "newest": self.newest_stamp,
        }

    def restore(self, snapshot: Mapping[str, Any], now: int) -> None:
        """Take over from a guard that has ended."""
        self.newest_stamp = snapshot["newest"]
        for digest, client in snapshot["over"]:
            self._finished.set(digest, _FinishedGoal(client, now + ID_REUSE_DELAY))
        for id, stamp, flow, client, sent in snapshot["goals"]:
            stage = GoalStage.SENT if sent else GoalStage.WAITING
            self.add(Goal(bytes.fromhex(id), stamp, flow, client, stage=stage, last_seen=now))

    def _round_robin(self) -> Iterator[Goal]:
        """Yield a goal of each client, then another of each, and so on; first those at the server.

        A client with many goals must not keep those of others from being known.
        """
        turns: Counter[tuple[str, GoalStage]] = Counter()
        ranked = []
        for goal in self:
            turns[goal.client, goal.stage] += 1
            ranked.append((turns[goal.client, goal.stage], goal.stage is GoalStage.WAITING, goal))
        yield from (goal for _, _, goal in sorted(ranked, key=lambda each: each[:2]))


def _digest(id: bytes) -> str:
    return blake2b(id, digest_size=16).hexdigest()


def _fit_into_bytes(size: int, rows: Iterable[list[Any]]) -> list[list[Any]]:
    """Return the first rows, as many as fit into `size` bytes of JSON."""
    fitting = []
    for row in rows:
        size -= sum(8 + 6 * len(each) if isinstance(each, str) else 24 for each in row)
        if size < 0:
            break
        fitting.append(row)
    return fitting

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

MOST_GOALS = 1024
"""The most goals of clients that may not be over; the guard refuses more."""
MOST_FOREIGN = 64
"""The most goals without a client that are known."""
LONGEST_ID = 1024
REMEMBERED = 4096
AGAIN_AFTER = 5 * SECOND
"""A client may use an id again so long after its goal was over, as with actionlib's own server."""
_MOST_EARLY = 64
_MOST_CLIENTS = 256
_MOST_KEPT = 256
_MOST_KEPT_BYTES = 1 << 16

K = TypeVar("K")
V = TypeVar("V")


class Where(Enum):
    """Where a goal is."""

    WAITING = "with the guard"
    SENT = "with the server"


@dataclass(slots=True, eq=False)
class Goal:
    """A goal, whose it is, and since when it is where it is (ns).

    `status` is what the server last said of it (actionlib_msgs/GoalStatus), and `seen` when.
    `stopped` says why it was cancelled by the guard. A goal of the server's own, or one that was
    there before us, has no client.
    """

    id: bytes
    stamp: int
    flow: str
    client: str
    message: bytes = b""
    where: Where = Where.WAITING
    seen: int = 0
    status: int = 0
    stopped: str = ""


@dataclass(frozen=True, slots=True)
class _Over:
    """A goal that is over: whose it was and until when its id may not be used again (ns)."""

    client: str
    until: int


class _Newest(Generic[K, V]):
    """The entries that were set last, `most` of them."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._entries: OrderedDict[K, V] = OrderedDict()

    def __contains__(self, key: K) -> bool:
        return key in self._entries

    def set(self, key: K, value: V) -> None:
        self._entries.pop(key, None)
        self._entries[key] = value
        if len(self._entries) > self._most:
            self._entries.popitem(last=False)

    def get(self, key: K) -> V | None:
        return self._entries.get(key)

    def pop(self, key: K) -> V | None:
        return self._entries.pop(key, None)

    def last(self, most: int) -> list[tuple[K, V]]:
        return list(self._entries.items())[-most:]


class Goals:
    """Who owns which goal of an action."""

    def __init__(self) -> None:
        self._goals: OrderedDict[bytes, Goal] = OrderedDict()
        self._waiting: Counter[str] = Counter()
        self.newest = 0
        self._over: _Newest[str, _Over] = _Newest(REMEMBERED)
        self._early: _Newest[tuple[str, bytes], int] = _Newest(_MOST_EARLY)
        self._until: _Newest[str, int] = _Newest(_MOST_CLIENTS)

    def __iter__(self) -> Iterator[Goal]:
        return iter(tuple(self._goals.values()))

    def __len__(self) -> int:
        return len(self._goals)

    def find(self, id: bytes) -> Goal | None:
        """Return the goal that is called so and is not over."""
        return self._goals.get(id)

    def why_not(self, id: bytes, client: str, now: int) -> str:
        """Return why a goal of `client` may not be called `id`, or nothing."""
        if len(id) > LONGEST_ID:
            return f"a goal id of {len(id)} bytes, the most is {LONGEST_ID}"
        if id in self._goals:
            return "another goal has this id"
        if len(client) > LONGEST_ID:
            return f"a client's name of {len(client)} letters"
        over = self._over.get(_digest(id))
        if over and (over.client != client or now < over.until):
            return "a goal that is over had this id"
        foreign = 0 if client else sum(not goal.client for goal in self)
        return f"{MOST_FOREIGN} goals have no client" if foreign >= MOST_FOREIGN else ""

    def add(self, goal: Goal) -> None:
        """Take a goal, of which `why_not` said nothing."""
        self._goals[goal.id] = goal
        self._waiting[goal.flow] += goal.where is Where.WAITING

    def waiting(self, flow: str) -> int:
        """Return how many goals of a flow wait."""
        return self._waiting[flow]

    def send(self, goal: Goal, now: int) -> None:
        """Know that a goal is with the server."""
        self._waiting[goal.flow] -= goal.where is Where.WAITING
        goal.where, goal.seen = Where.SENT, now

    def end(self, goal: Goal, now: int) -> None:
        """Forget a goal that is over, but for its id."""
        if self._goals.pop(goal.id, None):
            self._waiting[goal.flow] -= goal.where is Where.WAITING
            self.remember(goal.id, goal.client, now)

    def remember(self, id: bytes, client: str, now: int) -> None:
        """Know that a goal is over."""
        self._over.set(_digest(id), _Over(client, now + AGAIN_AFTER))

    def is_over(self, id: bytes) -> bool:
        """Tell whether a goal is known to be over."""
        return _digest(id) in self._over

    def cancelled(self, client: str, id: bytes, stamp: int, now: int) -> list[Goal]:
        """Return the goals that a cancel of `client` means, all of them its own.

        As in actionlib: an id, or with a stamp all goals up to then, or with neither all goals.
        What is meant and has not come yet is noted; see `came_cancelled`.
        """
        if stamp:
            self._until.set(client, max(stamp, self._until.get(client) or 0))
        if id and id not in self._goals:
            self._early.set((client, id), now)
        everything = not id and not stamp
        own = (goal for goal in self if goal.client == client)
        return [g for g in own if everything or g.id == id or (stamp and 0 < g.stamp <= stamp)]

    def came_cancelled(self, goal: Goal, now: int) -> bool:
        """Tell whether a goal that comes now was cancelled before it came."""
        noted = self._early.pop((goal.client, goal.id))
        meant = noted is not None and now - noted < AGAIN_AFTER
        return meant or 0 < goal.stamp <= (self._until.get(goal.client) or 0)

    def in_order(self, stamp: int) -> int:
        """Return the stamp that a goal of `stamp` goes with: none is older than the one before.

        SimpleActionServers refuse a goal that is older than their last.
        """
        self.newest = max(self.newest, stamp)
        return self.newest

    def kept(self) -> Mapping[str, Any]:
        """Return what a successor of this guard must know, as JSON of at most 128 KiB."""
        goals = (
            [g.id.hex(), g.stamp, g.flow, g.client, g.where is Where.SENT] for g in self._fair()
        )
        over = ([digest, o.client] for digest, o in reversed(self._over.last(_MOST_KEPT)))
        return {
            "goals": _within(_MOST_KEPT_BYTES, goals),
            "over": _within(_MOST_KEPT_BYTES, over)[::-1],
            "newest": self.newest,
        }

    def restore(self, kept: Mapping[str, Any], now: int) -> None:
        """Take over from a guard that has ended."""
        self.newest = kept["newest"]
        for digest, client in kept["over"]:
            self._over.set(digest, _Over(client, now + AGAIN_AFTER))
        for id, stamp, flow, client, sent in kept["goals"]:
            where = Where.SENT if sent else Where.WAITING
            self.add(Goal(bytes.fromhex(id), stamp, flow, client, where=where, seen=now))

    def _fair(self) -> Iterator[Goal]:
        """Yield a goal of each client, then another of each, and so on; first those at the server.

        A client with many goals must not keep those of others from being known.
        """
        turns: Counter[tuple[str, Where]] = Counter()
        ranked = []
        for goal in self:
            turns[goal.client, goal.where] += 1
            ranked.append((turns[goal.client, goal.where], goal.where is Where.WAITING, goal))
        yield from (goal for _, _, goal in sorted(ranked, key=lambda each: each[:2]))


def _digest(id: bytes) -> str:
    return blake2b(id, digest_size=16).hexdigest()


def _within(most: int, rows: Iterable[list[Any]]) -> list[list[Any]]:
    """Return the first rows, as many as fit into `most` bytes of JSON."""
    found = []
    for row in rows:
        most -= sum(8 + 6 * len(each) if isinstance(each, str) else 24 for each in row)
        if most < 0:
            break
        found.append(row)
    return found

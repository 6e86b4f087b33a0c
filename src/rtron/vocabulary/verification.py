"""One audit as a result: every planned path, whether it is closed, and who is there beside it."""

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, replace

from rtron.vocabulary.enums import Mode, StringEnum
from rtron.vocabulary.names import matches_node
from rtron.vocabulary.plan import Plan, UnguardedPath
from rtron.vocabulary.streams import build_streams


class PathState(StringEnum):
    """What is known of a planned path."""

    CLOSED = "closed"
    OPEN = "open"
    DRIFT = "drift"
    UNKNOWN = "unknown"
    NOT_SEEN = "not seen"
    ABSENT = "absent"


@dataclass(frozen=True, slots=True, kw_only=True)
class GuardedPath:
    """One way to a guarded node, or from a publisher into the guard.

    `node` is at the outer end, `topic` the public name, `private` what it should use instead.
    `foreign` are those who are there and should not be: names or addresses.
    """

    topic: str
    private: str
    node: str
    state: PathState
    reason: str = ""
    foreign: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Verification:
    """The paths, what is wrong beside them, what no path leads through, and what was tried in vain.

    What was not seen is not closed: it may run where nobody looked. `without` takes out what is
    known to be switched off.
    """

    paths: tuple[GuardedPath, ...]
    problems: tuple[str, ...]
    unguarded: tuple[UnguardedPath, ...]
    proven: tuple[str, ...] = ()

    @property
    def is_closed(self) -> bool:
        """Tell whether the guard is in the way of everything that the plan names."""
        fine = (PathState.CLOSED, PathState.ABSENT)
        return not self.problems and all(path.state in fine for path in self.paths)

    @property
    def is_conclusive(self) -> bool:
        """Tell whether every path could be looked at, or another one is known open."""
        states = {path.state for path in self.paths}
        wrong = bool(self.problems) or bool(states & {PathState.OPEN, PathState.DRIFT})
        return wrong or not states & {PathState.UNKNOWN, PathState.NOT_SEEN}

    @property
    def not_seen(self) -> tuple[str, ...]:
        """The nodes of the plan of which nobody knows whether they run."""
        unseen = (path.node for path in self.paths if path.state is PathState.NOT_SEEN)
        return tuple(dict.fromkeys(unseen))

    def without(self, absent: Collection[str]) -> "Verification":
        """Return the same where nodes, or patterns, are known not to run; one that runs counts."""
        paths = (_as_absent(path, absent) for path in self.paths)
        return replace(self, paths=tuple(paths))


def _as_absent(path: GuardedPath, absent: Collection[str]) -> GuardedPath:
    is_absent = any(matches_node(name, path.node) for name in absent)
    if path.state is PathState.NOT_SEEN and is_absent:
        return replace(path, state=PathState.ABSENT)
    return path


def unguarded_paths(plan: Plan, running: Iterable[UnguardedPath]) -> Iterator[UnguardedPath]:
    """Yield what the plan itself leaves unguarded, then what `running` nodes offer beside that."""
    accepted = list(_accepted_paths(plan))
    yield from accepted
    known = {each.what for each in accepted}
    yield from (each for each in running if each.what not in known)


def _accepted_paths(plan: Plan) -> Iterator[UnguardedPath]:
    streams = build_streams(plan)
    for stream in streams:
        if stream.mode is Mode.OBSERVE:
            yield UnguardedPath(what=stream.topic, why="is only observed: everybody can publish it")
    guarded = {stream.topic for stream in streams}
    yield from (each for each in plan.unguarded if each.what not in guarded)
    for what in plan.accept_unenforceable:
        yield UnguardedPath(what=what, why="cannot be closed, and was accepted")

"""One audit as a result: every planned path, whether it is closed, and who is there beside it.

Pure: what the master and the nodes have answered comes in as `Answers`.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from rtron.guard.audit.ros1.bus_info import Link, plain
from rtron.guard.audit.ros1.expected_graph import Entrance, Expectations, meant
from rtron.guard.audit.ros1.foreign_connections import planned_sources, strangers_of
from rtron.guard.audit.ros1.node_addresses import Addresses
from rtron.guard.audit.ros1.registrations import Registered, foreign
from rtron.vocabulary import GUARD_NODE, Mode, Plan, PlannedTopic, Word, streams

_LOGGERS = ("/get_loggers", "/set_logger_level")
_PARAMETERS = "/set_parameters"


class PathState(Word):
    """What is known of a planned path."""

    CLOSED = "closed"
    OPEN = "open"
    DRIFT = "drift"
    UNKNOWN = "unknown"
    NOT_RUNNING = "not running"


@dataclass(frozen=True, slots=True, kw_only=True)
class Path:
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
class Unguarded:
    """A way to move the robot that the guard does not stand in."""

    what: str
    why: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Answers:
    """What was answered: the master's list, addresses by node, connections and process ids.

    `links` and `pids` lack a node that does not answer, `uris` one that the master does not know.
    """

    state: Registered
    services: tuple[tuple[str, str], ...] = ()
    uris: Mapping[str, str] = field(default_factory=dict)
    links: Mapping[str, frozenset[Link]] = field(default_factory=dict)
    pids: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Verification:
    """The paths, what is wrong beside them, and what no path leads through."""

    paths: tuple[Path, ...]
    problems: tuple[str, ...]
    unguarded: tuple[Unguarded, ...]

    @property
    def closed(self) -> bool:
        """Tell whether the guard is in the way of everything that runs."""
        fine = (PathState.CLOSED, PathState.NOT_RUNNING)
        return not self.problems and all(path.state in fine for path in self.paths)

    @property
    def told(self) -> bool:
        """Tell whether every path that runs could be looked at, or another one is known open."""
        states = {path.state for path in self.paths}
        wrong = bool(self.problems) or bool(states & {PathState.OPEN, PathState.DRIFT})
        return wrong or PathState.UNKNOWN not in states


def verify(plan: Plan, answers: Answers) -> Verification:
    """Compare what runs with what the plan says."""
    expected = Expectations(plan)
    known = _addresses(expected, answers)
    return Verification(
        paths=(*_exits(expected, answers, known), *_entrances(expected, answers)),
        problems=tuple(_problems(expected, answers)),
        unguarded=tuple(_unguarded(plan, expected, answers)),
    )


def asked_nodes(expected: Expectations, state: Registered) -> frozenset[str]:
    """Return the nodes whose address has to be known: all on planned topics, and the guard's."""
    listed = (nodes for side in (state.publishers, state.subscribers) for nodes in side.values())
    return expected.own.union(*listed)


def _addresses(expected: Expectations, answers: Answers) -> Addresses:
    own = {node: uri for node, uri in answers.uris.items() if node in expected.own}
    known = Addresses(own)
    for node, uri in answers.uris.items():
        known.learn(plain(uri), node)
    return known


def _exits(expected: Expectations, answers: Answers, known: Addresses) -> Iterator[Path]:
    for public, private in expected.outputs.items():
        topic = expected.topics[private]
        for pattern in topic.subscribers:
            if pattern in expected.own:
                continue
            nodes = [n for n in _running(answers, public, private) if meant((pattern,), n)]
            if not nodes:
                state = PathState.NOT_RUNNING
                yield Path(topic=public, private=private, node=pattern, state=state)
            for node in nodes:
                yield _exit(expected, answers, known, public, node)


def _running(answers: Answers, *topics: str) -> list[str]:
    """Return who listens to one of the topics, or could be asked."""
    listening = {n for topic in topics for n in answers.state.subscribers.get(topic, ())}
    return sorted(listening | answers.links.keys())


def _exit(
    expected: Expectations, answers: Answers, known: Addresses, public: str, node: str
) -> Path:
    private = expected.outputs[public]
    heard = {name: expected.topics[name] for name in (public, private)}
    state, reason, strangers = _heard(answers, known, heard, node)
    if state is PathState.CLOSED and node in answers.state.subscribers.get(public, ()):
        state, reason = PathState.DRIFT, f"listens to {public}: its remap is missing"
    elif state is PathState.CLOSED and not planned_sources(
        heard[private], answers.links[node], known
    ):
        state, reason = PathState.DRIFT, f"is not connected to {private}"
    return Path(
        topic=public, private=private, node=node, state=state, reason=reason, foreign=strangers
    )


def _heard(
    answers: Answers, known: Addresses, heard: Mapping[str, PlannedTopic], node: str
) -> tuple[PathState, str, tuple[str, ...]]:
    if node not in answers.links:
        return PathState.UNKNOWN, "does not say who speaks to it", ()
    found = strangers_of(node, answers.links[node], heard, known)
    if not found:
        return PathState.CLOSED, "", ()
    names = tuple(sorted({known.node_of(each.link) or each.link.source for each in found}))
    return PathState.OPEN, f"hears {', '.join(names)} past the guard", names


def _entrances(expected: Expectations, answers: Answers) -> Iterator[Path]:
    for way in expected.entrances:
        for pattern in way.publishers:
            yield from _entrance(expected, answers, way, pattern)


def _entrance(
    expected: Expectations, answers: Answers, way: Entrance, pattern: str
) -> Iterator[Path]:
    publishers = answers.state.publishers
    outside = [n for n in sorted(publishers.get(way.public, ())) if n not in expected.own]
    inside = [n for n in sorted(publishers.get(way.private, ())) if n not in expected.own]
    found = {n: PathState.CLOSED for n in inside if meant((pattern,), n)}
    found |= {n: PathState.DRIFT for n in outside if meant((pattern,), n)}
    for node, state in (found or {pattern: PathState.NOT_RUNNING}).items():
        drifts = state is PathState.DRIFT
        reason = f"publishes {way.public}: its remap is missing" if drifts else ""
        yield Path(topic=way.public, private=way.private, node=node, state=state, reason=reason)


def _problems(expected: Expectations, answers: Answers) -> Iterator[str]:
    for node in sorted(expected.guarding):
        if node not in answers.uris:
            yield f"the guard's node {node} is not running"
        elif node not in answers.pids:
            yield f"the guard's node {node} does not answer"
    guard = answers.pids.get(GUARD_NODE)
    for node in sorted(answers.pids.keys() & expected.own):
        if guard is not None and answers.pids[node] != guard:
            yield f"{node} is no node of the guard: another process has taken its name"
    yield from (alarm.reason for alarm in foreign(answers.state, expected))


def _unguarded(plan: Plan, expected: Expectations, answers: Answers) -> Iterator[Unguarded]:
    for stream in streams(plan):
        if stream.mode is Mode.OBSERVE:
            yield Unguarded(what=stream.topic, why="is only observed: everybody can publish it")
    for what in plan.accept_unenforceable:
        yield Unguarded(what=what, why="cannot be closed, and was accepted")
    for service, node in answers.services:
        if expected.heard(node) and not service.endswith(_LOGGERS):
            changes = service.endswith(_PARAMETERS)
            told = "changes parameters of" if changes else "is a service of"
            yield Unguarded(what=service, why=f"{told} {node}, behind the guard")

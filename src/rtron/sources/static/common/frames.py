"""TF frames of an app: those that several nodes broadcast, and those that nobody does."""

from collections import defaultdict
from collections.abc import Collection, Hashable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from graphlib import CycleError, TopologicalSorter
from itertools import chain
from typing import TypeAlias

from rtron.sources.declaration import Declaration, DeclarationKind, FrameBroadcast
from rtron.sources.static.common.node_part import NodePart
from rtron.vocabulary import (
    Evidence,
    WiringFact,
    WiringFactKind,
)
from rtron.vocabulary.names import TRANSFORM_TOPICS, TRANSFORMS

_LIFECYCLE = "/change_state"
_NEAR_RATIO = 0.8
_MOST_COMPARED = 200
"""Among more frames a near one tells nothing, and comparing them takes long."""
_SHORT = 2
"""Names of so many letters are in many others."""
_Frame: TypeAlias = tuple[str, str]
"""The topic that a transform goes to, and its child frame."""
_Uses: TypeAlias = dict[str, dict[str, Evidence]]
"""Frames, with the nodes that use them, and where these do."""
_OTHER_BASE = {"base_link": "base_footprint", "base_footprint": "base_link"}
"""The names of a robot's base (REP 105, REP 120), of which many a robot has one alone."""
_MISSING = {True: WiringFactKind.MISSING_FRAME, False: WiringFactKind.POSSIBLE_MISSING_FRAME}


@dataclass(frozen=True, slots=True)
class _Broadcaster:
    """A node, where it starts, and a transform that it broadcasts; `is_managed` in ROS 2 alone.

    A managed node does nothing until another activates it.
    """

    node: str
    start: Evidence
    frame: FrameBroadcast
    is_managed: bool


@dataclass(slots=True)
class FrameBroadcasters:
    """Which nodes broadcast each frame; each node once, by the first transform that counts.

    `activated` are the managed nodes that are activated when the app starts, `stamps` the frames of
    messages, with the nodes that send them, `look_ups` those that nodes look up. `is_whole` says
    that all transforms are known.
    """

    ros: int
    activated: set[str] = field(default_factory=set)
    stamps: _Uses = field(default_factory=lambda: defaultdict(dict))
    look_ups: _Uses = field(default_factory=lambda: defaultdict(dict))
    is_whole: bool = True
    _nodes: dict[_Frame, dict[Hashable, _Broadcaster]] = field(
        default_factory=lambda: defaultdict(dict)
    )

    def add(self, part: NodePart, topic: str) -> None:
        """Note the frames of a part of a node, whose transforms go to a topic."""
        frames = [frame for frame in part.interface.frames if frame.child]
        sends = any(_sends_transforms(each) for each in part.interface.declarations)
        is_known = all(frame.child and frame.parent for frame in part.interface.frames)
        self.is_whole &= is_known and topic == TRANSFORMS
        self.is_whole &= bool(frames) or not sends or _has_modelled_frames(part)
        for use in part.interface.frame_uses:
            takes_slash = self.ros == 1 and not use.is_look_up
            uses = self.look_ups if use.is_look_up else self.stamps
            name = use.frame.strip("/") if takes_slash else use.frame.rstrip("/")
            uses[name].setdefault(node_name(part), use.evidence)
        for frame in frames if "{" not in topic else ():
            known = self._nodes[topic, frame.child.strip("/")]
            first = known.get(_identity(part))
            is_certain = frame.is_certain and not part.node.is_uncertain
            if first is None or (is_certain and not first.frame.is_certain):
                found = replace(frame, parent=frame.parent.strip("/"), is_certain=is_certain)
                known[_identity(part)] = _broadcaster(part, found)

    def facts(self) -> Iterator[WiringFact]:
        """Yield facts for each frame that several nodes broadcast, one for each of its parents."""
        for (topic, child), nodes in sorted(self._nodes.items()):
            certain = [node for node in nodes.values() if self._is_certain(node)]
            counted = certain if certain[1:] else list(nodes.values())
            if counted[1:]:
                frame = child if topic == TRANSFORMS else f"{child} on {topic}"
                yield from _facts(_kind(certain), frame, counted)

    def loops(self) -> Iterator[WiringFact]:
        """Yield a fact for each frame of each loop: one that is below itself, through others."""
        parents = {
            frame: {each.frame.parent: each for each in known.values() if self._is_certain(each)}
            for frame, known in sorted(self._nodes.items())
        }
        looped = _below_loops(parents)
        if len(looped) > _MOST_COMPARED:
            return
        above = {frame: _frames_above(frame, parents) for frame in looped}
        for topic, child in sorted(looped):
            nodes = parents[topic, child]
            loop = {e for e in above[topic, child] if child in above.get((topic, e), ())}
            if len(loop) > 1:
                within = [node for parent, node in nodes.items() if parent in loop]
                yield WiringFact(
                    kind=WiringFactKind.FRAME_LOOP,
                    subject=min(loop),
                    value=child,
                    others=tuple(node.node for node in within),
                    evidence=tuple(
                        place for node in within for place in (node.start, *node.frame.evidence)
                    ),
                )

    def stray_frames(self) -> Iterator[WiringFact]:
        """Yield a fact for each frame of messages that no transform has, if a near one is there.

        tf2 takes no frame with a slash before it. tf, which readers of ROS 1 may use, leaves it
        out, and looks below the prefix that a node has.
        """
        for frame, nodes, near, is_likely in self._missing(self.stamps):
            if is_likely:
                yield self._missing_fact(WiringFactKind.STRAY_FRAME, frame, nodes, near)

    def missing_frames(self) -> Iterator[WiringFact]:
        """Yield a fact for each frame that nodes look up and that no transform has.

        A node that looks up the near one too tries one after the other.
        """
        for frame, nodes, near, is_likely in self._missing(self.look_ups):
            others = {n: p for n, p in nodes.items() if n not in self.look_ups.get(near, ())}
            if others:
                yield self._missing_fact(_MISSING[is_likely], frame, others, near)

    def _missing(self, uses: _Uses) -> Iterator[tuple[str, dict[str, Evidence], str, bool]]:
        """Yield the frames that no transform has, their users, one that may be meant, if likely.

        All transforms must be known, unless nothing but a slash parts a frame from one of them.
        """
        broadcasters = chain.from_iterable(nodes.values() for nodes in self._nodes.values())
        parents = {each.frame.parent for each in broadcasters} - {""}
        known = parents.union(child for _, child in self._nodes)
        for frame, nodes in sorted(uses.items()):
            bare = frame.lstrip("/")
            has_slash = bare != frame and bare in known
            if has_slash or (self.is_whole and known and not self._has(frame, known)):
                near = bare if has_slash else _near_frame(frame, sorted(known))
                base = "".join(known & {_OTHER_BASE.get(frame, "")})
                yield frame, nodes, near or base, bool(near) or base in parents

    def _missing_fact(
        self, kind: WiringFactKind, frame: str, nodes: Mapping[str, Evidence], near: str
    ) -> WiringFact:
        broadcasters = chain.from_iterable(
            known.values() for (_, child), known in self._nodes.items() if child == near
        )
        places = (*nodes.values(), *(each.start for each in broadcasters))
        return WiringFact(
            kind=kind, subject=frame, value=near, others=tuple(nodes), evidence=places
        )

    def _has(self, frame: str, transformed: Collection[str]) -> bool:
        """Return whether a frame is in a transform, or none at all."""
        if self.ros > 1:
            return not frame or frame in transformed
        return any(f"/{each}".endswith(f"/{frame}") for each in ("", *transformed))

    def _is_certain(self, node: _Broadcaster) -> bool:
        return node.frame.is_certain and (not node.is_managed or node.node in self.activated)


def _below_loops(parents: Mapping[_Frame, Collection[str]]) -> set[_Frame]:
    """Return the frames of loops, and those between and below them."""
    sorter = TopologicalSorter(
        {f: [(f[0], each) for each in above] for f, above in parents.items()}
    )
    with suppress(CycleError):
        sorter.prepare()
    rest = set(parents)
    while ready := sorter.get_ready():
        rest.difference_update(ready)
        sorter.done(*ready)
    return rest


def _frames_above(frame: _Frame, parents: Mapping[_Frame, Collection[str]]) -> set[str]:
    """Return the frames that a frame is below, itself too if it is in a loop."""
    topic, _ = frame
    found, pending = set[str](), list(parents[frame])
    while pending:
        parent = pending.pop()
        if parent not in found:
            found.add(parent)
            pending.extend(parents.get((topic, parent), ()))
    return found


def _has_modelled_frames(part: NodePart) -> bool:
    """Return whether a model tells of transforms, which its node's parameters may turn off."""
    entries = part.model.walk() if part.model else ()
    return any(entry.broadcast is not None for entry in entries)


def _sends_transforms(declaration: Declaration) -> bool:
    is_sent = declaration.kind is DeclarationKind.PUBLISH
    return is_sent and declaration.name in TRANSFORM_TOPICS


def _near_frame(frame: str, others: Sequence[str]) -> str:
    """Return a frame with words or a namespace more or less, or one that is a slip away."""
    if len(others) > _MOST_COMPARED:
        return ""
    inside = (other for other in others if _extends(frame, other) or _extends(other, frame))
    close = get_close_matches(frame, others, 1, _NEAR_RATIO)
    mixed = (other for other in others if _has_its_words(frame, other))
    return next(chain(inside, close, mixed), "")


def _has_its_words(one: str, other: str) -> bool:
    """Return whether one of two names has all words of the other, two at least, in any order."""
    fewer, more = sorted((set(one.split("_")), set(other.split("_"))), key=len)
    return len(fewer) > 1 and fewer <= more


def _extends(longer: str, shorter: str) -> bool:
    before, found, behind = longer.partition(shorter)
    is_part = (not before or before[-1] in "_/") and (not behind or behind[0] in "_/")
    return bool(found) and is_part and len(shorter) > _SHORT


def _broadcaster(part: NodePart, frame: FrameBroadcast) -> _Broadcaster:
    is_managed = any(each.name.endswith(_LIFECYCLE) for each in part.interface.declarations)
    return _Broadcaster(node_name(part), part.node.evidence, frame, is_managed)


def node_name(part: NodePart) -> str:
    """Return what a node calls itself, or is called by the launch."""
    return next((created.name for created in part.interface.nodes), part.node.name)


def _identity(part: NodePart) -> Hashable:
    """Return what tells a node from others; those without a name differ in what starts them."""
    node, name = part.node, node_name(part)
    is_named = not {"{", "*"}.intersection(name)
    return name if is_named else (name, node.evidence, node.site.args)


def _facts(kind: WiringFactKind, child: str, nodes: Iterable[_Broadcaster]) -> Iterator[WiringFact]:
    by_parent: dict[str, list[_Broadcaster]] = defaultdict(list)
    for node in nodes:
        by_parent[node.frame.parent].append(node)
    for parent, below in sorted(by_parent.items()):
        yield WiringFact(
            kind=kind,
            subject=child,
            value=parent,
            others=tuple(node.node for node in below),
            evidence=tuple(place for node in below for place in (node.start, *node.frame.evidence)),
        )


def _kind(certain: Sequence[_Broadcaster]) -> WiringFactKind:
    """Return the kind of what certainly happens; parents that are not known may be the same."""
    if not certain[1:]:
        return WiringFactKind.POSSIBLE_DOUBLE_FRAME
    parents = {node.frame.parent for node in certain} - {""}
    is_fixed = all(node.frame.is_fixed for node in certain)
    if is_fixed and len(parents) <= 1:
        return WiringFactKind.DOUBLE_FIXED_FRAME
    return WiringFactKind.DOUBLE_FRAME

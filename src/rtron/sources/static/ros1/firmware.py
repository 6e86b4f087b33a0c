"""The firmware behind a bridge of rosserial: what a sketch publishes and subscribes.

Its topics and services are those of the bridge, which makes them for it by the names that it sends
(ROS wiki: rosserial).
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path
from typing import TypeAlias

from rtron.folders import walk
from rtron.sources.declaration import DeclarationKind
from rtron.sources.models.common.schema import NodeRole
from rtron.sources.static.common.interface_resolver import InterfaceResolver
from rtron.sources.static.common.node_part import NodePart
from rtron.sources.static.common.node_sources import file_content
from rtron.sources.static.common.task import InterpretationTask, TaskKind
from rtron.vocabulary import Evidence, UnresolvedItem

_Sketch: TypeAlias = tuple[Path, ...]
"""The files of one program, the one that it is called after first."""
MAX_FOLDERS = 5_000
_NOT_OF_THE_APP = frozenset(
    {"examples", "libraries", "ros_lib", "archive", "archived", "deprecated", "old"}
)
"""Folders of Arduino's libraries, whose sketches are examples, and of what is no more in use."""
_MAX_SKETCHES, _MAX_BRIDGES = 16, 4
_SKETCH = ".ino"
_SOURCES = (_SKETCH, ".cpp", ".cc", ".c")
_ROSSERIAL = re.compile(rb'^[ \t]*#[ \t]*include[ \t]*[<"]ros\.h[>"]', re.MULTILINE)
_START = re.compile(rb"^[ \t]*(?:void[ \t]+setup|int[ \t]+main)[ \t]*\(", re.MULTILINE)
_ENDS = (DeclarationKind.PUBLISH, DeclarationKind.SUBSCRIBE)
_READ = "is taken for the firmware behind it; what runs there may be another"
_GUESSED = "is taken for the firmware behind it; it may be behind another bridge"


@dataclass(frozen=True)
class _Bridge:
    """A bridge of rosserial, the readings of it with each of its sketches, and their topics."""

    part: NodePart
    read: list[NodePart] = field(default_factory=list)
    topics: set[str] = field(default_factory=set)

    def add(self, read: NodePart, topics: set[str]) -> None:
        self.read.append(read)
        self.topics.update(topics)

    def fitness(self, sketch: _Sketch, topics: set[str]) -> tuple[int, int, int]:
        """Return how well a sketch fits: beside those alike, else by its name, else alone."""
        path = "/".join(sketch[0].parts[-2:])
        return len(topics & self.topics), len(_words(path) & _words(self.name)), -len(self.read)

    @property
    def name(self) -> str:
        return self.part.node.name


def with_firmware(parts: Sequence[NodePart], resolver: InterfaceResolver) -> list[NodePart]:
    """Return the parts of an app, bridges of rosserial with what their sketches declare.

    Of several sketches or bridges those count that exchange topics with the app. A bridge with more
    than one has their topics together, with a note that one of them runs there.
    """
    found = [p for p in parts if p.model is not None and p.model.role is NodeRole.FIRMWARE]
    bridges = [_Bridge(part) for part in found[:_MAX_BRIDGES]]
    folders = resolver.workspace.folders if bridges else ()
    sketches = list(islice(_sketches(folders), _MAX_SKETCHES))
    if len(bridges) == len(sketches) == 1:
        bridges[0].add(_read_sketch(bridges[0].part, sketches[0], resolver, _READ), set())
    else:
        _distribute(sketches, bridges, parts, resolver)
    is_known = any(bridge.read for bridge in bridges)
    read = {bridge.name: _with_sketches(bridge, sketches, is_known=is_known) for bridge in bridges}
    return [read.get(p.node.name, p) if p in found else p for p in parts]


def _distribute(
    sketches: Iterable[_Sketch],
    bridges: Sequence[_Bridge],
    parts: Sequence[NodePart],
    resolver: InterfaceResolver,
) -> None:
    """Give each sketch that exchanges topics with the app to the bridge that it fits best."""
    why = _GUESSED if bridges[1:] else _READ
    for sketch in sketches:
        read = [_read_sketch(bridge.part, sketch, resolver, why) for bridge in bridges]
        topics = [_exchanged(each, parts) for each in read]
        ranks = [b.fitness(sketch, t) if t else () for b, t in zip(bridges, topics, strict=True)]
        if any(ranks):
            best = ranks.index(max(ranks))
            bridges[best].add(read[best], topics[best])


def _exchanged(bridge: NodePart, parts: Iterable[NodePart]) -> set[str]:
    """Return what a bridge with a sketch hears of others of the app, or sends to them."""
    own = {(each.kind, each.name) for each in bridge.interface.declarations}
    others = (each for part in parts for each in part.interface.declarations)
    turned = dict(zip(_ENDS, reversed(_ENDS), strict=True))
    return {
        each.name
        for each in others
        if each.kind in turned and not each.implicit and (turned[each.kind], each.name) in own
    }


def _words(name: str) -> set[str]:
    return set(re.findall(r"[a-z]{3,}", name.lower())) - {"ino", "cpp", "src", "main"}


def _read_sketch(
    bridge: NodePart, sketch: _Sketch, resolver: InterfaceResolver, why: str
) -> NodePart:
    task = InterpretationTask(kind=TaskKind.SKETCH, sources=sketch, site=bridge.node.site)
    (found,) = resolver.resolve_parts([replace(bridge, model=None, known_model=None, task=task)])
    of_bridge = bridge.interface
    note = UnresolvedItem(
        what=f"sketch {sketch[0].name}", why=why, evidence=(Evidence(file=str(sketch[0])),)
    )
    interface = replace(
        found.interface,
        declarations=(*of_bridge.declarations, *found.interface.declarations),
        unresolved=(note, *found.interface.unresolved),
    )
    return replace(bridge, task=task, interface=interface)


def _with_sketches(bridge: _Bridge, sketches: Sequence[_Sketch], *, is_known: bool) -> NodePart:
    """Return what is read of a bridge; with several sketches, or none that fits, with a note."""
    if len(bridge.read) == 1:
        return bridge.read[0]
    if not sketches or (is_known and not bridge.read):
        return bridge.part
    note = UnresolvedItem(
        what=f"firmware of {bridge.name}",
        why="several sketches or bridges are here: which belongs to it is not known",
        evidence=tuple(Evidence(file=str(sketch[0])) for sketch in sketches),
    )
    interface = bridge.part.interface
    declared = {
        (each.kind, each.name): each for part in bridge.read for each in part.interface.declarations
    }
    interface = replace(
        interface,
        declarations=tuple(declared.values()) or interface.declarations,
        unresolved=(*interface.unresolved, note),
    )
    return replace(bridge.part, interface=interface)


def _sketches(folders: Iterable[Path]) -> Iterator[_Sketch]:
    """Yield the files of each program that uses rosserial, by folders."""
    for count, (folder, inner, names) in enumerate(
        listing for top in folders for listing in walk(top)
    ):
        inner[:] = sorted(n for n in inner if n.lower() not in _NOT_OF_THE_APP and n[0] != ".")
        yield from _programs([Path(folder) / n for n in sorted(names) if n.endswith(_SOURCES)])
        if count > MAX_FOLDERS:
            return


def _programs(files: Sequence[Path]) -> Iterator[_Sketch]:
    """Yield the programs of a folder: all its files where one starts, else each that starts."""
    contents = {file: file_content(file) for file in files}
    if not any(map(_ROSSERIAL.search, contents.values())):
        return
    starts = [file for file, text in contents.items() if _START.search(text)]
    if len(starts) > 1 and starts[0].suffix != _SKETCH:
        yield from ((file,) for file in starts if _ROSSERIAL.search(contents[file]))
    else:
        yield tuple(sorted(files, key=lambda f: (f.suffix != _SKETCH, f.stem != f.parent.name)))

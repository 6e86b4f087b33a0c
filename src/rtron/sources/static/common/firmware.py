"""The firmware behind a bridge of rosserial or micro-ROS: what a sketch publishes and subscribes.

In ROS 1 its topics and services are those of the bridge, which makes them for it by the names that
it sends (ROS wiki: rosserial). In ROS 2 it has nodes of its own (micro.ros.org: Architecture).
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain, islice
from pathlib import Path
from typing import TypeAlias

from rtron.folders import walk
from rtron.sources.code.program_runner import FIRMWARE_STARTS
from rtron.sources.declaration import Declaration, DeclarationKind
from rtron.sources.models.common.schema import NodeRole
from rtron.sources.static.common.interface_resolver import InterfaceResolver
from rtron.sources.static.common.node_part import NodePart
from rtron.sources.static.common.node_sources import file_content
from rtron.sources.static.common.task import InterpretationTask, TaskKind
from rtron.vocabulary import Evidence, UnresolvedItem
from rtron.vocabulary.remap_rules import remaps_for_node

_Sketch: TypeAlias = tuple[Path, ...]
"""The files of one program, the one that it is called after first."""
MAX_FOLDERS = 5_000
_NOT_OF_THE_APP = frozenset(
    [
        "examples",
        "libraries",
        "ros_lib",
        "test",
        "tests",
        "archive",
        "archived",
        "deprecated",
        "old",
    ]
)
"""Folders of Arduino's libraries, whose sketches are examples, of tests, and of what is past."""
_MAX_SKETCHES, _MAX_BRIDGES, _MAX_FILES = 8, 4, 60
_ARDUINO = ".ino"
_SOURCES = (_ARDUINO, ".cpp", ".cc", ".c")
_INCLUDES = {
    1: re.compile(rb'^[ \t]*#[ \t]*include[ \t]*[<"]ros\.h[>"]', re.MULTILINE),
    2: re.compile(rb'^[ \t]*#[ \t]*include[ \t]*[<"](?:rclc/|micro_ros_)\w+\.h[>"]', re.MULTILINE),
}
"""How a program gets the client library of rosserial, and of micro-ROS."""
_NAMES = "|".join(FIRMWARE_STARTS)
_START = re.compile(
    rf'^(?:extern[ \t]+"C"[ \t]+)?(?:void|int)[ \t]+(?:{_NAMES})[ \t]*\('.encode(), re.MULTILINE
)
_QUOTED = re.compile(rb'^[ \t]*#[ \t]*include[ \t]*[<"]([\w./-]+)[">]', re.MULTILINE)
_LIBRARIES = ("lib", "include", "libraries")
_OTHER_ENDS = {
    DeclarationKind.PUBLISH: DeclarationKind.SUBSCRIBE,
    DeclarationKind.SUBSCRIBE: DeclarationKind.PUBLISH,
}
_READ = "is taken for the firmware behind it; what runs there may be another"
_GUESSED = "is taken for the firmware behind it; it may be behind another bridge"
_OPEN = "several sketches or bridges are here: which belongs to it is not known"


@dataclass(frozen=True)
class _Bridge:
    """A bridge to firmware, the readings of it with each of its sketches, and their topics."""

    part: NodePart
    sketches: list[_Sketch] = field(default_factory=list)
    read: list[NodePart] = field(default_factory=list)
    topics: set[str] = field(default_factory=set)

    def add(self, sketch: _Sketch, read: NodePart, topics: set[str]) -> None:
        self.sketches.append(sketch)
        self.read.append(read)
        self.topics.update(topics)

    def fitness(self, sketch: _Sketch, topics: set[str]) -> tuple[int, int, int]:
        """Return how well a sketch fits: beside those alike, else by its name, else alone."""
        path = "/".join(sketch[0].parts[-2:])
        alike = _words(path) & _words(self.part.node.name)
        return len(topics & self.topics), len(alike), -len(self.read)


def with_firmware(parts: Sequence[NodePart], resolver: InterfaceResolver) -> list[NodePart]:
    """Return the parts of an app, bridges to firmware with what their sketches declare.

    Of several sketches or bridges those count that exchange topics with the app. A bridge with more
    than one has all of them, and a note that it is not known which runs there.
    """
    found = [p for p in parts if p.model is not None and p.model.role is NodeRole.FIRMWARE]
    bridges = [_Bridge(part) for part in found[:_MAX_BRIDGES]]
    sketches = list(islice(_sketches(resolver.workspace.folders, found), _MAX_SKETCHES))
    if len(found) == len(sketches) == 1:
        for sketch, behind in _read_sketches(found, sketches, resolver):
            bridges[0].add(sketch, behind[0], set())
    else:
        _distribute(sketches, bridges, parts, resolver)
    if not sketches:
        return list(parts)
    read = {id(bridge.part): _with_notes(bridge, bridges, sketches) for bridge in bridges}
    return list(chain.from_iterable(read.get(id(part), [part]) for part in parts))


def _distribute(
    sketches: Sequence[_Sketch],
    bridges: Sequence[_Bridge],
    parts: Sequence[NodePart],
    resolver: InterfaceResolver,
) -> None:
    """Give each sketch that exchanges topics with the app to the bridge that it fits best."""
    for sketch, read in _read_sketches([bridge.part for bridge in bridges], sketches, resolver):
        topics = [_exchanged(each, parts) for each in read]
        ranks = [b.fitness(sketch, t) if t else () for b, t in zip(bridges, topics, strict=True)]
        if any(ranks):
            best = ranks.index(max(ranks))
            bridges[best].add(sketch, read[best], topics[best])


def _exchanged(bridge: NodePart, parts: Iterable[NodePart]) -> set[str]:
    """Return what a bridge with a sketch hears of others of the app, or sends to them."""
    own = {(each.kind, _topic(bridge, each)) for each in bridge.interface.declarations}
    others = (
        (_OTHER_ENDS[each.kind], _topic(part, each))
        for part in parts
        for each in part.interface.declarations
        if each.kind in _OTHER_ENDS and not each.implicit
    )
    return {topic for kind, topic in others if (kind, topic) in own}


def _topic(part: NodePart, declared: Declaration) -> str:
    """Return a declared name as the launch remaps it."""
    node = part.node
    rules = remaps_for_node(node.process_remap_rules, declared.node or node.name)
    remaps = {**dict(node.site.remaps), **{rule.source: rule.target for rule in rules}}
    return remaps.get(declared.name, declared.name)


def _words(name: str) -> set[str]:
    return set(re.findall(r"[a-z]{3,}", name.lower())) - {"ino", "cpp", "src", "main"}


def _read_sketches(
    bridges: Sequence[NodePart], sketches: Sequence[_Sketch], resolver: InterfaceResolver
) -> Iterator[tuple[_Sketch, list[NodePart]]]:
    """Yield each sketch with what it declares behind each bridge."""
    pairs = [(bridge, sketch) for sketch in sketches for bridge in bridges]
    read = iter(resolver.resolve_parts([_with_task(*pair) for pair in pairs]))
    for sketch in sketches:
        yield sketch, [_with_own(next(read), bridge) for bridge in bridges]


def _with_task(bridge: NodePart, sketch: _Sketch) -> NodePart:
    task = InterpretationTask(kind=TaskKind.SKETCH, sources=sketch, site=bridge.node.site)
    return replace(bridge, model=None, known_model=None, task=task)


def _with_own(read: NodePart, bridge: NodePart) -> NodePart:
    """Return what a sketch declares, and what the bridge declares itself."""
    declared = (*bridge.interface.declarations, *read.interface.declarations)
    owner = next((made.name for made in read.interface.nodes), bridge.owner)
    return replace(read, owner=owner, interface=replace(read.interface, declarations=declared))


def _with_notes(
    bridge: _Bridge, bridges: Sequence[_Bridge], sketches: Iterable[_Sketch]
) -> list[NodePart]:
    """Return what is read of a bridge; with several sketches, or none that fits, itself too."""
    if len(bridge.read) == 1:
        sketch = bridge.sketches[0]
        why = _GUESSED if bridges[1:] else _READ
        return [_with_note(bridge.read[0], f"sketch {sketch[0].name}", why, [sketch])]
    if not bridge.read and any(each.read for each in bridges):
        return [bridge.part]
    what = f"firmware of {bridge.part.node.name}"
    others = (replace(each.interface, last_messages=()) for each in bridge.read)
    read = [replace(p, interface=i) for p, i in zip(bridge.read, others, strict=True)]
    return [_with_note(bridge.part, what, _OPEN, sketches), *read]


def _with_note(part: NodePart, what: str, why: str, sketches: Iterable[_Sketch]) -> NodePart:
    places = tuple(Evidence(file=str(sketch[0])) for sketch in sketches)
    note = UnresolvedItem(what=what, why=why, evidence=places)
    interface = replace(part.interface, unresolved=(note, *part.interface.unresolved))
    return replace(part, interface=interface)


def _sketches(folders: Iterable[Path], bridges: Sequence[NodePart]) -> Iterator[_Sketch]:
    """Yield the files of each program that joins ROS as the bridges do, by folders."""
    listings = (listing for top in folders for listing in walk(top)) if bridges else ()
    for folder, inner, names in islice(listings, MAX_FOLDERS):
        inner[:] = sorted(n for n in inner if n.lower() not in _NOT_OF_THE_APP and n[0] != ".")
        paths = (Path(folder) / name for name in sorted(names) if name.endswith(_SOURCES))
        files = [path for path in paths if not path.is_symlink()]
        yield from _programs(files[:_MAX_FILES], _INCLUDES[bridges[0].node.site.ros])


def _programs(files: Sequence[Path], include: re.Pattern[bytes]) -> Iterator[_Sketch]:
    """Yield the programs of a folder: a sketch of Arduino is all of it, else each that starts."""
    contents = {file: file_content(file) for file in files}
    joining = [file for file, text in contents.items() if include.search(text)]
    starts = [file for file, text in contents.items() if _START.search(text)]
    is_own_header = bool(joining) and (joining[0].parent / "ros.h").exists()
    if not (joining and starts) or is_own_header:
        return
    programs = [file for file in starts if file in joining]
    if len(programs) > 1 and all(file.suffix != _ARDUINO for file in files):
        yield from (_with_libraries([file]) for file in programs)
    else:
        order = sorted(files, key=lambda f: (f.suffix != _ARDUINO, f.stem != f.parent.name))
        yield _with_libraries(order)


def _with_libraries(files: Sequence[Path]) -> _Sketch:
    """Return a program with the sources of the libraries that lie beside it, by what it includes.

    They lie in `lib`, `include` (docs.platformio.org: Project) and `libraries` (Arduino's
    sketchbook), beside the folder or above it.
    """
    folder = files[0].parent
    included = {name for file in files for name in _QUOTED.findall(file_content(file))}
    stems = {name.decode().rpartition("/")[2].partition(".")[0] for name in included}
    places = [at / name for at in (folder, folder.parent) for name in _LIBRARIES]
    found = [
        Path(inner) / name
        for place in places
        for inner, _, names in islice(walk(place), _MAX_FILES)
        for name in sorted(names)
        if name.endswith((*_SOURCES, ".h", ".hpp")) and name.partition(".")[0] in stems
    ]
    return (*files, *(path for path in found if not path.is_symlink()))[:_MAX_FILES]

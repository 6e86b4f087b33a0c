"""The firmware behind a bridge of rosserial: what an Arduino sketch publishes and subscribes.

Its topics and services are those of the bridge, which makes them for it by the names that it sends
(ROS wiki: rosserial).
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from rtron.folders import walk
from rtron.sources.declaration import DeclarationKind
from rtron.sources.models.common.schema import NodeRole
from rtron.sources.static.common.interface_resolver import InterfaceResolver
from rtron.sources.static.common.node_part import NodePart
from rtron.sources.static.common.node_sources import file_content
from rtron.sources.static.common.task import InterpretationTask, TaskKind
from rtron.vocabulary import Evidence, UnresolvedItem

MAX_FOLDERS = 5_000
_NOT_OF_THE_APP = frozenset(
    {"examples", "libraries", "ros_lib", "archive", "archived", "deprecated", "old"}
)
"""Folders of Arduino's libraries, whose sketches are examples, and of what is no more in use."""
_MAX_SKETCHES = 8
_READ = "is taken for the firmware behind it; what runs there may be another"


def with_firmware(parts: Sequence[NodePart], resolver: InterfaceResolver) -> list[NodePart]:
    """Return the parts of an app, a lone bridge of rosserial with what its sketch declares.

    Of several sketches those count that hear what the app sends: their topics together, with a note
    that one of them runs there. Of several bridges each has a note on the sketches.
    """
    bridges = [p for p in parts if p.model is not None and p.model.role is NodeRole.FIRMWARE]
    sketches = list(_sketches(resolver.workspace.folders)) if bridges else []
    if not sketches:
        return list(parts)
    bridge = bridges[0]
    read: list[NodePart] = []
    if len(bridges) == 1:
        read = [_read_sketch(bridge, each, resolver) for each in sketches[:_MAX_SKETCHES]]
        read = [each for each in read if _hears(each, parts)] if sketches[1:] else read
    if len(read) == 1:
        return [read[0] if p is bridge else p for p in parts]
    return [_with_note(p, sketches, read) if p in bridges else p for p in parts]


def _hears(bridge: NodePart, parts: Iterable[NodePart]) -> bool:
    """Return whether a bridge with a sketch subscribes what others of the app publish."""
    declared = (each for part in parts for each in part.interface.declarations)
    sent = {each.name for each in declared if each.kind is DeclarationKind.PUBLISH}
    own = (e for e in bridge.interface.declarations if e.kind is DeclarationKind.SUBSCRIBE)
    return any(each.name in sent for each in own)


def _read_sketch(
    bridge: NodePart, sketch: tuple[Path, ...], resolver: InterfaceResolver
) -> NodePart:
    task = InterpretationTask(kind=TaskKind.SKETCH, sources=sketch, site=bridge.node.site)
    (found,) = resolver.resolve_parts([replace(bridge, model=None, known_model=None, task=task)])
    of_bridge = bridge.interface
    note = UnresolvedItem(
        what=f"sketch {sketch[0].name}", why=_READ, evidence=(Evidence(file=str(sketch[0])),)
    )
    interface = replace(
        found.interface,
        declarations=(*of_bridge.declarations, *found.interface.declarations),
        unresolved=(note, *found.interface.unresolved),
    )
    return replace(bridge, task=task, interface=interface)


def _with_note(
    bridge: NodePart, sketches: Iterable[tuple[Path, ...]], read: Iterable[NodePart]
) -> NodePart:
    note = UnresolvedItem(
        what=f"firmware of {bridge.node.name}",
        why="several sketches or bridges are here: which belongs to it is not known",
        evidence=tuple(Evidence(file=str(sketch[0])) for sketch in sketches),
    )
    interface = bridge.interface
    declared = {
        (each.kind, each.name): each for part in read for each in part.interface.declarations
    }
    interface = replace(
        interface,
        declarations=tuple(declared.values()) or interface.declarations,
        unresolved=(*interface.unresolved, note),
    )
    return replace(bridge, interface=interface)


def _sketches(folders: Iterable[Path]) -> Iterator[tuple[Path, ...]]:
    """Yield the files of each sketch that uses rosserial, the one called like its folder first."""
    for count, (folder, inner, names) in enumerate(
        listing for top in folders for listing in walk(top)
    ):
        inner[:] = [n for n in inner if n.lower() not in _NOT_OF_THE_APP and n[0] != "."]
        files = [Path(folder) / name for name in sorted(names) if name.endswith(".ino")]
        if any(b"<ros.h>" in file_content(file) for file in files):
            yield tuple(sorted(files, key=lambda file: file.stem != file.parent.name))
        if count > MAX_FOLDERS:
            return

"""The firmware behind rosserial: a sketch of Arduino in the folders of an app.

Its topics and services are those of the bridge, which makes them for it by the names that it sends
(ROS wiki: rosserial).
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from rtron.folders import walk
from rtron.sources.models.common.schema import NodeRole
from rtron.sources.static.common.interface_resolver import InterfaceResolver
from rtron.sources.static.common.node_part import NodePart
from rtron.sources.static.common.node_sources import file_content
from rtron.sources.static.common.task import InterpretationTask, TaskKind
from rtron.vocabulary import Evidence, UnresolvedItem

MAX_FOLDERS = 5_000
_NOT_OF_THE_APP = frozenset({"examples", "libraries", "ros_lib"})
"""Folders of Arduino's libraries, whose sketches are examples."""
_READ = "is taken for the firmware behind it; what runs there may be another"


def with_firmware(parts: Sequence[NodePart], resolver: InterfaceResolver) -> list[NodePart]:
    """Return the parts of an app, a lone bridge of rosserial with what the lone sketch declares.

    Where there are several, each bridge has a note on them.
    """
    bridges = [p for p in parts if p.model is not None and p.model.role is NodeRole.FIRMWARE]
    sketches = list(_sketches(resolver.workspace.folders)) if bridges else []
    if not sketches:
        return list(parts)
    bridge = bridges[0]
    if len(bridges) == len(sketches) == 1:
        return [_read_sketch(p, sketches[0], resolver) if p is bridge else p for p in parts]
    return [_with_note(p, sketches) if p in bridges else p for p in parts]


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


def _with_note(bridge: NodePart, sketches: Iterable[tuple[Path, ...]]) -> NodePart:
    note = UnresolvedItem(
        what=f"firmware of {bridge.node.name}",
        why="several sketches or bridges are here: which belongs to it is not known",
        evidence=tuple(Evidence(file=str(sketch[0])) for sketch in sketches),
    )
    interface = bridge.interface
    return replace(bridge, interface=replace(interface, unresolved=(*interface.unresolved, note)))


def _sketches(folders: Iterable[Path]) -> Iterator[tuple[Path, ...]]:
    """Yield the files of each sketch that uses rosserial, the one called like its folder first."""
    for count, (folder, inner, names) in enumerate(
        listing for top in folders for listing in walk(top)
    ):
        inner[:] = [n for n in inner if n not in _NOT_OF_THE_APP and not n.startswith(".")]
        files = [Path(folder) / name for name in sorted(names) if name.endswith(".ino")]
        if any(b"<ros.h>" in file_content(file) for file in files):
            yield tuple(sorted(files, key=lambda file: file.stem != file.parent.name))
        if count > MAX_FOLDERS:
            return

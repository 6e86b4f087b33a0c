"""Plan + launch of ROS 2 -> guarded launch (paper section 5.1, Coordination Node Deployment).

Rules that begin with a node's name reach nodes whose names the launch file does not tell: a rule's
prefix is a node's name without its namespace (docs.ros.org: node arguments).
"""

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rtron.errors import InputError
from rtron.planning.instrument.common.cells import Cell
from rtron.planning.instrument.common.guarded_launch import (
    GUARD_SCRIPT,
    EnforcementGap,
    GuardedLaunch,
    GuardFiles,
    PlacedRemap,
)
from rtron.planning.instrument.common.remap_coverage import RemapCoverage
from rtron.planning.instrument.common.remaps import NodeRemaps, enforced_streams, plan_remaps
from rtron.planning.instrument.ros2.enclaves import Enclaves
from rtron.planning.instrument.ros2.launch_copies import LaunchCopies
from rtron.planning.instrument.ros2.wrapper import PrivateNames, is_wrapper, remap_table
from rtron.vocabulary import (
    GUARD_NODE,
    LaunchFile,
    LaunchNode,
    LaunchTree,
    Plan,
    Stream,
    matches_node,
)
from rtron.vocabulary.remap_rules import UNKNOWN_NAME, remaps_for_node

_UNQUOTABLE = re.compile(r"""[\s"'()&<>$\\\x00-\x1f]""")


def instrument_ros2(
    tree: LaunchTree,
    plan: Plan,
    out: Path,
    guard: GuardFiles,
    enclaves: Enclaves | None = None,
    cells: Sequence[Cell] = (),
) -> GuardedLaunch:
    """Return the guarded launch of ROS 2: the app's own, plus remaps, plus the guard.

    With `enclaves`, each process starts in its own; the nodes of `cells` start in theirs.

    XML and YAML are rewritten, a Python launch file is wrapped, also where another includes it.
    `out` is the launch file; what else it needs lies in a folder beside it. Nothing is written.
    Raise InputError if `out` cannot be that file, if a file of the launch cannot be changed, or if
    nothing starts the node of a cell.
    """
    out = out.absolute()
    folder = out.with_suffix(".d")
    _check_out(tree, out, folder)
    enforced = enforced_streams(plan)
    table = remap_table(enforced)
    launch_time = _LaunchTimeNodes(tree, table, missing_nodes(table, tree))
    scripts = {cell.manifest.node: cell.script for cell in cells}
    _check_started(launch_time, scripts)
    candidates = table if launch_time.has_python() else launch_time.missing
    node_remaps = {**plan_remaps(tree, enforced), **plan_unnamed_remaps(tree, enforced, candidates)}
    copies = LaunchCopies(
        folder, node_remaps, table, launch_time.missing, tree.inputs, enclaves, scripts
    )
    root = copies.root(tree.root, GUARD_SCRIPT, GUARD_NODE.strip("/"))
    placed = {
        node: remaps for node, remaps in node_remaps.items() if node not in copies.unreachable
    }
    coverage = RemapCoverage(tree, enforced, placed, copies.unreachable)
    texts = {**copies.texts, **guard.texts(), **_script_texts(enclaves, cells)}
    notes = (*launch_time.notes(coverage), *(note for cell in cells for note in cell.notes))
    return GuardedLaunch(
        launch=out,
        folder=folder,
        files={**{folder / name: text for name, text in texts.items()}, out: root},
        remaps=(*(one for each in placed.values() for one in each), *launch_time.wrapped()),
        unenforceable=tuple(
            replace(gap, accepted=gap.what in plan.accept_unenforceable)
            for gap in coverage.gaps()
            if not launch_time.is_decided_at_launch(gap)
        ),
        notes=tuple(dict.fromkeys(notes)),
    )


def _script_texts(enclaves: Enclaves | None, cells: Sequence[Cell]) -> dict[str, str]:
    """Return the files through which processes start in their enclaves and cells, by name."""
    texts = enclaves.texts() if enclaves else {}
    return texts | {name: text for cell in cells for name, text in cell.texts().items()}


@dataclass(frozen=True, slots=True)
class _LaunchTimeNodes:
    """Tells what only the running launch will decide from what stays open."""

    tree: LaunchTree
    table: PrivateNames
    missing: tuple[str, ...]

    def wrapped(self) -> Iterator[PlacedRemap]:
        """Yield what the wrappers of Python launch files do for nodes that none else starts."""
        for node in self.missing if self.has_python() else ():
            for public, private in self.table[node].items():
                yield PlacedRemap(node=node, topic=public, written=public, target=private)

    def is_decided_at_launch(self, gap: EnforcementGap) -> bool:
        """Tell whether an end is closed when a Python launch file starts the node."""
        return gap.what in self.missing and self.has_python()

    def notes(self, coverage: RemapCoverage) -> Iterator[str]:
        """Yield what is decided when the launch runs, and what could not be read."""
        if not self.has_python():
            yield from coverage.notes()
        elif self.missing:
            yield f"guarded if a Python launch file starts them: {', '.join(self.missing)}"
        for node in filter(is_unnamed, self.tree.nodes()):
            node_text = f"{node.package} {node.type}".strip()
            yield f"{node_text} (line {node.line}) has no name that is known before it starts"
        for one in self.tree.unresolved:
            location = one.evidence[0]
            yield f"{location.file}:{location.line}: {one.what}: {one.why}"

    def has_python(self) -> bool:
        """Tell whether wrappers see what the launch starts, beside what is rewritten."""
        return any(file.path.endswith(".py") for file in self.tree.root.walk())


def _check_started(launch_time: _LaunchTimeNodes, nodes: Collection[str]) -> None:
    """Refuse a cell whose node nothing starts under its name: it would run outside."""
    started = {node.name for node in launch_time.tree.nodes()}
    for node in nodes:
        if node not in started and not launch_time.has_python():
            help = "give the node its name in the launch file, or start it by hand: `rtron cell`"
            raise InputError(
                f"this launch does not start {node}, for which there is a cell", help=help
            )


def _check_out(tree: LaunchTree, out: Path, folder: Path) -> None:
    kind = Path(tree.root.path).suffix
    if folder == out or _UNQUOTABLE.search(str(out)) or not _same_kind(kind, out.suffix):
        help = f"choose a name such as guarded.launch{kind}, in a folder of plain name"
        raise InputError("cannot be the guarded launch file", path=str(out), help=help)
    for path in (Path(file.path).resolve() for file in tree.root.walk()):
        if path == out.resolve() or folder.resolve() in path.parents:
            help = "write the guarded launch to another place"
            raise InputError("would be overwritten", path=str(path), help=help)
    if any(node.name == GUARD_NODE for node in tree.nodes()) or is_wrapper(tree.root.path):
        help = "instrument the app's own launch file"
        raise InputError("starts a guard already", path=tree.root.path, help=help)


def _same_kind(kind: str, other: str) -> bool:
    """Tell whether launch reads two files alike, by their suffixes."""
    return kind == other or {kind, other} == {".yaml", ".yml"}


def is_unnamed(node: LaunchNode) -> bool:
    """Tell whether a node's name or namespace is known only to the running launch."""
    namespace, _, base = node.name.rpartition("/")
    return UNKNOWN_NAME in {base, namespace}


def missing_nodes(planned: Collection[str], tree: LaunchTree) -> tuple[str, ...]:
    """Return the names of a plan that no launched node has."""
    names = [node.name for node in tree.nodes() if not is_unnamed(node)]
    return tuple(
        name for name in planned if not any(matches_node(name, launched) for launched in names)
    )


def plan_unnamed_remaps(
    tree: LaunchTree, enforced: tuple[Stream, ...], names: Collection[str]
) -> NodeRemaps:
    """Return the rules for nodes that may be one of several, by name."""
    return {
        node: rules
        for node in tree.nodes()
        if is_unnamed(node) and (rules := _rules(node, enforced, names))
    }


def _rules(
    node: LaunchNode, enforced: tuple[Stream, ...], names: Collection[str]
) -> tuple[PlacedRemap, ...]:
    found: dict[str, list[PlacedRemap]] = {}
    for name in filter(lambda name: _may_have_name(node, name), names):
        base = name.rpartition("/")[2]
        for placed in _remaps_for(_with_name(node, name), enforced):
            written = f"{base}:{placed.written}"
            found.setdefault(written, []).append(replace(placed, written=written))
    return tuple(same[0] for same in found.values() if len({one.target for one in same}) == 1)


def _may_have_name(node: LaunchNode, name: str) -> bool:
    if UNKNOWN_NAME in name:
        return False
    namespace, _, base = node.name.rpartition("/")
    inside = namespace == UNKNOWN_NAME or name.startswith(f"{namespace}/")
    return inside and base in {UNKNOWN_NAME, name.rpartition("/")[2]}


def _with_name(node: LaunchNode, name: str) -> LaunchNode:
    """Return the node as it is under a name."""
    rules = ((remap.written_source, remap.written_target) for remap in node.remaps)
    return replace(node, name=name, remaps=tuple(remaps_for_node(rules, name)))


def _remaps_for(node: LaunchNode, enforced: tuple[Stream, ...]) -> tuple[PlacedRemap, ...]:
    tree = LaunchTree(root=LaunchFile(path="", nodes=(node,)))
    remaps: Mapping[LaunchNode, tuple[PlacedRemap, ...]] = plan_remaps(tree, enforced)
    return remaps.get(node, ())

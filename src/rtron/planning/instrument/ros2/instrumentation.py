"""Plan + launch of ROS 2 -> guarded launch (paper section 5.1, Coordination Node Deployment)."""

import re
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rtron.errors import InputError
from rtron.planning.instrument.common.guard_files import PLAN, SCRIPT
from rtron.planning.instrument.common.guarded_launch import Instrumented, PlacedRemap, Unenforceable
from rtron.planning.instrument.common.remap_coverage import Findings
from rtron.planning.instrument.common.remaps import enforced_streams, wire
from rtron.planning.instrument.ros1.instrumentation import GUARD_COMMAND
from rtron.planning.instrument.ros2.launch_copies import Copies
from rtron.planning.instrument.ros2.unnamed_nodes import absent, unnamed, wire_unnamed
from rtron.planning.instrument.ros2.wrapper import PrivateNames, is_wrapper, remap_table
from rtron.vocabulary import GUARD_NODE, LaunchTree, Plan

_UNQUOTABLE = re.compile(r"""[\s"'()&<>$\\\x00-\x1f]""")
_SUFFIXES = (".py", ".xml", ".yaml", ".yml")


def instrument_ros2(
    tree: LaunchTree,
    plan: Plan,
    out: Path,
    *,
    plan_text: str,
    command: Sequence[str] = GUARD_COMMAND,
) -> Instrumented:
    """Return the guarded launch of ROS 2: the app's own, plus remaps, plus the guard.

    XML and YAML are rewritten, a Python launch file is wrapped, also where another includes it.
    `out` is the launch file; what else it needs lies in a folder beside it. Nothing is written.
    Raise InputError if `out` cannot be that file, or if a file of the launch cannot be changed.
    """
    out = out.absolute()
    folder = out.with_suffix(".d")
    _check_out(tree, out, folder)
    enforced = enforced_streams(plan)
    table = remap_table(enforced)
    sorted_out = _Sorted(tree, table, absent(table, tree))
    may_be = table if sorted_out.python() else sorted_out.missing
    wiring = {**wire(tree, enforced), **wire_unnamed(tree, enforced, may_be)}
    copies = Copies(folder, wiring, table, sorted_out.missing, tree.choices)
    root = copies.root(tree.root, SCRIPT, GUARD_NODE.strip("/"))
    placed = {node: remaps for node, remaps in wiring.items() if node not in copies.lost}
    findings = Findings(tree, enforced, placed, copies.lost)
    beside = {**copies.texts, SCRIPT: _script(command), PLAN: plan_text}
    return Instrumented(
        launch=out,
        folder=folder,
        files={**{folder / name: text for name, text in beside.items()}, out: root},
        remaps=(*(one for each in placed.values() for one in each), *sorted_out.wrapped()),
        unenforceable=tuple(
            replace(end, accepted=end.what in plan.accept_unenforceable)
            for end in findings.unenforceable()
            if not sorted_out.later(end)
        ),
        notes=tuple(dict.fromkeys(sorted_out.notes(findings))),
    )


@dataclass(frozen=True, slots=True)
class _Sorted:
    """Tells what only the running launch will decide from what stays open."""

    tree: LaunchTree
    table: PrivateNames
    missing: tuple[str, ...]

    def wrapped(self) -> Iterator[PlacedRemap]:
        """Yield what the wrappers of Python launch files do for nodes that none else starts."""
        for node in self.missing if self.python() else ():
            for public, private in self.table[node].items():
                yield PlacedRemap(node=node, topic=public, written=public, target=private)

    def later(self, end: Unenforceable) -> bool:
        """Tell whether an end is closed when a Python launch file starts the node."""
        return end.what in self.missing and self.python()

    def notes(self, findings: Findings) -> Iterator[str]:
        """Yield what is decided when the launch runs, and what could not be read."""
        if not self.python():
            yield from findings.notes()
        elif self.missing:
            yield f"guarded if a Python launch file starts them: {', '.join(self.missing)}"
        for node in filter(unnamed, self.tree.nodes()):
            where = f"{node.package} {node.type}".strip()
            yield f"{where} (line {node.line}) has no name that is known before it starts"
        for one in self.tree.unresolved:
            place = one.evidence[0]
            yield f"{place.file}:{place.line}: {one.what}: {one.why}"

    def python(self) -> bool:
        """Tell whether wrappers see what the launch starts, beside what is rewritten."""
        return any(file.path.endswith(".py") for file in self.tree.root.walk())


def _script(command: Sequence[str]) -> str:
    return f'#!/bin/sh\nexec {shlex.join(command)} --plan "${{0%/*}}/{PLAN}"\n'


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

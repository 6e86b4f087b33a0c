"""Plan + launch -> guarded launch (paper section 5.1, Coordination Node Deployment)."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from rtron.errors import InputError
from rtron.planning.instrument.common.cells import Cell
from rtron.planning.instrument.common.guard_files import GuardFiles, guard_element
from rtron.planning.instrument.common.guarded_launch import EnforcementGap, GuardedLaunch
from rtron.planning.instrument.common.remap_coverage import RemapCoverage
from rtron.planning.instrument.common.remaps import enforced_streams, plan_remaps
from rtron.planning.instrument.ros1.launch_copies import LaunchCopies
from rtron.planning.instrument.ros1.launch_prefix_script import STARTER_SCRIPT
from rtron.planning.instrument.ros1.overlay import overlay_files
from rtron.planning.instrument.ros1.runtime_launch import RuntimeLaunchTree, merge_launches
from rtron.planning.instrument.ros1.runtime_launch_reach import find_reachable_launches
from rtron.vocabulary import GUARD_NODE, LaunchTree, Plan

_NOTE = "# A launch-prefix: the command behind it is not run.\n"
_NO_PACKAGES: Mapping[str, Path] = {}
_UNQUOTABLE = re.compile(r"""["'&<>$\\\x00-\x1f]""")


def instrument_ros1(
    tree: LaunchTree,
    plan: Plan,
    out: Path,
    guard: GuardFiles,
    *,
    started: Sequence[RuntimeLaunchTree] = (),
    packages: Mapping[str, Path] = _NO_PACKAGES,
    cells: Sequence[Cell] = (),
) -> GuardedLaunch:
    """Return the guarded launch: the app's own launch, plus remaps, plus the guard.

    `out` is its launch file; what else it needs lies in a folder beside it. `started` are the
    launch files that nodes start themselves, `packages` where the app's packages lie, `cells` the
    nodes that run in one. Nothing is written. InputError if `out` cannot be that file, or if a file
    of the launch cannot be changed.
    """
    out = out.absolute()
    folder = out.with_suffix(".d")
    app = merge_launches(tree, started)
    _check_out(app, out, folder)
    enforced = enforced_streams(plan)
    node_remaps = plan_remaps(app, enforced)
    launches = find_reachable_launches(tree, started, node_remaps, packages)
    node_remaps = {
        node: remaps for node, remaps in node_remaps.items() if node not in launches.unreachable
    }
    copies = LaunchCopies(node_remaps, _scripts(app, launches.starters, cells))
    root = copies.root(tree.root, folder.name, guard_element(folder.name))
    overlay = overlay_files(folder, launches, copies, (out, folder))
    cell_texts = {name: text for cell in cells for name, text in cell.texts().items()}
    texts = {**copies.texts, **guard.texts(_NOTE), **cell_texts}
    coverage = RemapCoverage(app, enforced, node_remaps, launches.unreachable)
    return GuardedLaunch(
        launch=out,
        folder=folder,
        files={**{folder / n: text for n, text in texts.items()}, **overlay.files, out: root},
        copies=overlay.copies,
        links=overlay.links,
        remaps=tuple(p for placed in node_remaps.values() for p in placed if p.is_placeable),
        unenforceable=tuple(_with_acceptance(gap, plan) for gap in coverage.gaps()),
        notes=tuple(dict.fromkeys((*coverage.notes(), *(n for cell in cells for n in cell.notes)))),
    )


def _scripts(app: LaunchTree, starters: Iterable[str], cells: Sequence[Cell]) -> dict[str, str]:
    """Return the launch-prefixes of nodes; InputError if a node of a cell cannot have one."""
    scripts = dict.fromkeys(starters, STARTER_SCRIPT)
    started = {node.name for node in app.nodes()}
    for cell in cells:
        node = cell.manifest.node
        if node not in started:
            help = "start it by hand: `rtron cell`"
            raise InputError(
                f"this launch does not start {node}, for which there is a cell", help=help
            )
        if node in scripts:
            raise InputError(f"{node} starts launch files, and so cannot run in a cell")
        scripts[node] = cell.script
    return scripts


def _with_acceptance(gap: EnforcementGap, plan: Plan) -> EnforcementGap:
    return replace(gap, accepted=gap.what in plan.accept_unenforceable)


def _check_out(tree: LaunchTree, out: Path, folder: Path) -> None:
    if folder == out or _UNQUOTABLE.search(str(out)):
        help = "choose a name such as guarded.launch, in a folder of plain name"
        raise InputError("cannot be the guarded launch file", path=str(out), help=help)
    for path in (Path(file.path).resolve() for file in tree.root.walk()):
        if path == out.resolve() or folder.resolve() in path.parents:
            help = "write the guarded launch to another place"
            raise InputError("would be overwritten", path=str(path), help=help)
    if any(node.name == GUARD_NODE for node in tree.nodes()):
        help = "instrument the app's own launch file"
        raise InputError("starts a guard already", path=tree.root.path, help=help)

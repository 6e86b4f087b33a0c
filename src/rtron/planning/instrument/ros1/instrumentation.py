"""Plan + launch -> guarded launch (paper section 5.1, Coordination Node Deployment)."""

import re
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from rtron.errors import InputError
from rtron.planning.instrument.common.guard_files import (
    PLAN,
    SCRIPT,
    guard_element,
    guard_script,
)
from rtron.planning.instrument.common.guarded_launch import Instrumented, Unenforceable
from rtron.planning.instrument.common.remap_coverage import Findings
from rtron.planning.instrument.common.remaps import enforced_streams, wire
from rtron.planning.instrument.ros1.launch_copies import Copies
from rtron.planning.instrument.ros1.overlay_files import overlay_files
from rtron.planning.instrument.ros1.runtime_launch import Started, whole_app
from rtron.planning.instrument.ros1.runtime_launch_reach import reachable
from rtron.vocabulary import GUARD_NODE, LaunchTree, Plan

GUARD_COMMAND = (sys.executable, "-m", "rtron", "guard")

_NO_PACKAGES: Mapping[str, Path] = {}
_UNQUOTABLE = re.compile(r"""["'&<>$\\\x00-\x1f]""")


def instrument(
    tree: LaunchTree,
    plan: Plan,
    out: Path,
    *,
    plan_text: str,
    command: Sequence[str] = GUARD_COMMAND,
    started: Sequence[Started] = (),
    packages: Mapping[str, Path] = _NO_PACKAGES,
) -> Instrumented:
    """Return the guarded launch: the app's own launch, plus remaps, plus the guard.

    `out` is its launch file; what else it needs lies in a folder beside it. `plan_text` is the
    plan as the guard is to read it, `command` what runs the guard. `started` are the launch files
    that nodes start themselves, `packages` where the app's packages lie. Nothing is written.
    Raise InputError if `out` cannot be that file, or if a file of the launch cannot be changed.
    """
    out = out.absolute()
    folder = out.with_suffix(".d")
    whole = whole_app(tree, started)
    _check_out(whole, out, folder)
    enforced = enforced_streams(plan)
    wiring = wire(whole, enforced)
    found = reachable(tree, started, wiring, packages)
    wiring = {node: remaps for node, remaps in wiring.items() if node not in found.lost}
    copies = Copies(wiring, found.starters)
    root = copies.root(tree.root, folder.name, guard_element(folder.name))
    overlaid = overlay_files(folder, found, copies, (out, folder))
    beside = {**copies.texts, SCRIPT: guard_script(command), PLAN: plan_text}
    findings = Findings(whole, enforced, wiring, found.lost)
    return Instrumented(
        launch=out,
        folder=folder,
        files={**{folder / n: text for n, text in beside.items()}, **overlaid.files, out: root},
        copies=overlaid.copies,
        links=overlaid.links,
        remaps=tuple(p for placed in wiring.values() for p in placed if p.placeable),
        unenforceable=tuple(_judged(open_end, plan) for open_end in findings.unenforceable()),
        notes=tuple(dict.fromkeys(findings.notes())),
    )


def _judged(open_end: Unenforceable, plan: Plan) -> Unenforceable:
    return replace(open_end, accepted=open_end.what in plan.accept_unenforceable)


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

"""A launch file starts, includes or loads what is not there.

## What it finds

A launch starts a program that its package does not build or install, includes a launch file that is
not there, or loads a parameter file that is not there. The launch fails, or the node is missing or
has its defaults. So is a controller of ros2_control missing whose type its manager does not know.

For example, `my_robot/launch/base.launch` starts `base_node`, and CMakeLists.txt makes
`base_driver`.

## What to do

Correct the name, add the program to CMakeLists.txt or setup.py, or add the file.

## When it is silent

For packages outside of the workspace, and where CMakeLists.txt makes programs by commands of its
own.
"""

from collections import defaultdict
from collections.abc import Iterator
from pathlib import PurePath

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.findings.wiring_groups import WiringGroup, fact_finding, wiring_groups
from rtron.vocabulary import Certainty, Consequence, Finding, UnresolvedItem, WiringFactKind
from rtron.wording import join_names

_CAUSES = {
    1: "its package makes no {}, nor has an executable file of this name",
    2: "no build file of its package makes or installs {}",
}
_REMEDIES = {
    1: "correct the name, or build and install the program (a script: chmod +x)",
    2: "correct the name, or build and install the program",
}


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each program, launch file and parameter file that is not there."""
    nodes: dict[str, list[str]] = defaultdict(list)
    for node in app.graph.nodes:
        nodes[f"{node.package}/{node.executable}"].append(node.name)
    notes: dict[str, list[UnresolvedItem]] = defaultdict(list)
    for note in app.graph.unresolved:
        if note.missing:
            is_program = note.missing in nodes
            notes[note.missing if is_program else _ending(note.missing)].append(note)
    for missing, of_missing in notes.items():
        if missing in nodes:
            yield _program(missing, nodes[missing], of_missing, app.graph.ros)
        else:
            yield _file(missing, of_missing)
    yield from map(_controller, wiring_groups(app.graph, WiringFactKind.UNTYPED_CONTROLLER))


def _ending(path: str) -> str:
    return "/".join(PurePath(path).parts[-3:])


def _file(name: str, notes: list[UnresolvedItem]) -> Finding:
    return make_finding(
        RULE.name,
        name,
        summary=f"the launch ends, or leaves out what {PurePath(name).name} starts or sets",
        cause=f"it names {name}, which is not there",
        remedy="correct the path, or add the file to its package",
        consequence=Consequence.FAILURE,
        certainty=Certainty.LIKELY,
        evidence=[place for note in notes for place in note.evidence[:1]],
    )


def _controller(group: WiringGroup) -> Finding:
    others = f"; it knows that of {join_names(group.others)}" if group.others else ""
    meant = f"did you mean {group.others[0]}? Else give" if group.others else "give"
    return fact_finding(
        RULE.name,
        group,
        summary=f"{join_names(group.values)} cannot load the controller {group.subject}",
        cause=f"the controller manager is given no type for it{others}",
        remedy=f"{meant} it a type in the parameters of the manager",
    )


def _program(program: str, nodes: list[str], notes: list[UnresolvedItem], ros: int) -> Finding:
    nearest = next(filter(None, (note.nearest for note in notes)), "")
    return make_finding(
        RULE.name,
        nodes[0],
        summary=f"{join_names(nodes)} {'do' if nodes[1:] else 'does'} not start",
        cause=_CAUSES[ros].format(program),
        remedy="; ".join(filter(None, (_REMEDIES[ros], nearest))),
        consequence=Consequence.FAILURE,
        certainty=Certainty.LIKELY,
        nodes=nodes,
        evidence=[place for note in notes for place in note.evidence],
    )


RULE = FindingRule(
    name="missing_program",
    title="A launch file starts, includes or loads what is not there",
    consequence="failure: likely",
    since="0.1.0",
    check=check,
)

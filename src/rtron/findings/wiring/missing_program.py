"""A launch file starts what its own package does not have.

## What it finds

A node of the launch whose package is in the workspace, but whose program no build file of the
package makes or installs, nor, in ROS 1, is there an executable file of its name; and an included
launch file that is not there.

## Why it matters

The launch fails there, or starts without the node.

## Remedy

Correct the name in the launch file, or add the program to CMakeLists.txt or setup.py, or the file
to the package.

## Example

`my_robot/launch/base.launch` starts `base_node`, and CMakeLists.txt makes `base_driver`.
"""

from collections import defaultdict
from collections.abc import Iterator
from pathlib import PurePath

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import Certainty, Consequence, Finding, UnresolvedItem


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each node whose program, and each include whose file, is not there."""
    nodes: dict[str, list[str]] = defaultdict(list)
    for node in app.graph.nodes:
        nodes[f"{node.package}/{node.executable}"].append(node.name)
    notes: dict[str, list[UnresolvedItem]] = defaultdict(list)
    for note in app.graph.unresolved:
        if note.missing:
            for subject in nodes.get(note.missing, [PurePath(note.missing).name]):
                notes[subject].append(note)
    for subject, of_subject in notes.items():
        make = _program if subject in app.nodes else _launch_file
        yield make(subject, of_subject)


def _launch_file(name: str, notes: list[UnresolvedItem]) -> Finding:
    return make_finding(
        RULE.name,
        name,
        summary=f"the launch ends, or leaves out what {name} starts",
        cause=f"it includes {notes[0].missing}, which is not there",
        remedy="correct the path in the include, or add the file to its package",
        consequence=Consequence.FAILURE,
        certainty=Certainty.LIKELY,
        evidence=[place for note in notes for place in note.evidence[:1]],
    )


def _program(node: str, notes: list[UnresolvedItem]) -> Finding:
    return make_finding(
        RULE.name,
        node,
        summary=f"{node} does not start",
        cause=f"its package makes no {notes[0].missing}, nor has an executable file of this name",
        remedy="correct the name, or build and install the program (a script: chmod +x)",
        consequence=Consequence.FAILURE,
        certainty=Certainty.LIKELY,
        nodes=(node,),
        evidence=[place for note in notes for place in note.evidence],
    )


RULE = FindingRule(
    name="missing_program",
    title="A launch file starts what its own package does not have",
    consequence="failure: likely",
    since="0.2.0",
    check=check,
)

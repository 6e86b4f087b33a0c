"""A launch file starts what its own package does not have.

## What it finds

A node of the launch whose package is in the workspace, but whose program no build file of the
package makes or installs.

## Why it matters

The launch fails there, or starts without the node.

## Remedy

Correct the name in the launch file, or add the program to CMakeLists.txt or setup.py.

## Example

`my_robot/launch/base.launch` starts `base_node`, and CMakeLists.txt makes `base_driver`.
"""

from collections import defaultdict
from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.risks.wording import join_names
from rtron.vocabulary import Certainty, Consequence, Finding, UnresolvedItem
from rtron.vocabulary.causes import MISSING_PROGRAM


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each node whose program its package does not have."""
    notes: dict[str, list[UnresolvedItem]] = defaultdict(list)
    for note in app.graph.unresolved:
        if note.why == MISSING_PROGRAM:
            notes[note.what.removeprefix("node ").partition(" (")[0]].append(note)
    for node, of_node in notes.items():
        yield _finding(node, of_node)


def _finding(node: str, notes: list[UnresolvedItem]) -> Finding:
    programs = {note.what.partition(" (")[2].removesuffix(")") for note in notes}
    return make_finding(
        RULE.name,
        node,
        summary=f"{node} does not start",
        cause=f"no build file of its package makes {join_names(sorted(programs))}",
        remedy="correct the name in the launch file, or build and install the program",
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

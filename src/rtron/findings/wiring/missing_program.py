"""A launch file starts what its own package does not have.

## What it finds

A node of the launch whose package is in the workspace, but whose program no build file of the
package makes or installs; and an included launch file that its package, which is in the workspace,
does not have.

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
from rtron.risks.wording import join_names
from rtron.vocabulary import Certainty, Consequence, Finding, UnresolvedItem
from rtron.vocabulary.causes import MISSING_PROGRAM

_LAUNCH_FILES = (".launch", ".py", ".xml", ".yaml", ".yml")
_NO_FILE = (": is no file", ": No such file or directory", ": no such file")
"""How notes on an include end whose file is not there, behind its path."""


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each node whose program, and each include whose file, is not there."""
    notes: dict[str, list[UnresolvedItem]] = defaultdict(list)
    for note in app.graph.unresolved:
        if note.why == MISSING_PROGRAM:
            notes[note.what.removeprefix("node ").partition(" (")[0]].append(note)
    for node, of_node in notes.items():
        yield _finding(node, of_node)
    for note in app.graph.unresolved:
        ending = next((each for each in _NO_FILE if note.why.endswith(each)), "")
        path = PurePath(note.why.removesuffix(ending))
        if ending and note.what.startswith("include") and path.suffix in _LAUNCH_FILES:
            yield _missing_file(path, note)


def _missing_file(path: PurePath, note: UnresolvedItem) -> Finding:
    return make_finding(
        RULE.name,
        path.name,
        summary=f"the launch ends, or leaves out what {path.name} starts",
        cause=f"it includes {'/'.join(path.parts[-3:])}, which is not there",
        remedy="correct the path in the include, or add the file to its package",
        consequence=Consequence.FAILURE,
        certainty=Certainty.LIKELY,
        evidence=note.evidence[:1],
    )


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

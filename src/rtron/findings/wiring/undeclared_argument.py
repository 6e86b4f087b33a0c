"""An inclusion gives an argument that the included launch file does not know.

## What it finds

In ROS 2 launch drops an argument that an included file neither declares nor uses, without a word.
Where the file has one of a near name, which is not given, that keeps its default.

For example, a launch file gives `params_file` to `online_async_launch.py` of slam_toolbox, which
declares `slam_params_file`: the mapper runs with the default file.

## What to do

Correct the name.

## When it is silent

Where no name that the file declares is near, or a file behind the inclusion was not read.
"""

from collections.abc import Iterator
from pathlib import PurePath

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule
from rtron.findings.wiring_groups import fact_finding
from rtron.vocabulary import Finding, WiringFact, WiringFactKind


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each argument that no file behind an inclusion knows."""
    kind = WiringFactKind.UNDECLARED_ARGUMENT
    facts = {(fact.others, fact.subject): fact for fact in app.graph.wiring if fact.kind is kind}
    yield from map(_finding, facts.values())


def _finding(fact: WiringFact) -> Finding:
    file, near = PurePath("".join(fact.others[:1])).name, fact.value
    return fact_finding(
        RULE.name,
        fact,
        subject=f"{file}:{fact.subject}",
        summary=f"{file} does not know the argument {fact.subject}",
        cause=f"launch drops it, and {near} of {file} keeps its default",
        remedy=f"did you mean {near}?",
    )


RULE = FindingRule(
    name="undeclared_argument",
    title="An inclusion gives an argument that the included launch file does not know",
    consequence="failure: likely",
    since="0.1.0",
    check=check,
)

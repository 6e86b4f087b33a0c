"""A launch argument is given to a file that does not know it, or used and never given.

## What it finds

In ROS 2 launch drops an argument that an included file neither declares nor uses, without a word.
Where the file has one of a near name, which is not given, that keeps its default. Or a launch file
uses an argument that nobody gives and that has no default: launch ends there.

For example, a launch file gives `params_file` to `online_async_launch.py` of slam_toolbox, which
declares `slam_params_file`: the mapper runs with the default file.

## What to do

Correct the name, or declare the argument with a default.

## When it is silent

Where no name that the file declares is near, or a file behind the inclusion was not read. One that
is used is none where something of the launch was not read, and where you give it to the scan.
"""

from collections.abc import Iterator
from pathlib import PurePath

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule
from rtron.findings.wiring_groups import WiringGroup, fact_finding, wiring_groups
from rtron.vocabulary import Finding, WiringFact, WiringFactKind


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each argument that no file behind an inclusion knows."""
    kind = WiringFactKind.UNDECLARED_ARGUMENT
    facts = {(fact.others, fact.subject): fact for fact in app.graph.wiring if fact.kind is kind}
    yield from map(_finding, facts.values())
    yield from map(_missing, wiring_groups(app.graph, WiringFactKind.MISSING_ARGUMENT))


def _missing(group: WiringGroup) -> Finding:
    file, name = PurePath(group.values[0]).name, group.subject
    return fact_finding(
        RULE.name,
        group,
        subject=f"{file}:{name}",
        summary=f"{file} uses the argument {name}, which nobody gives",
        cause="no launch file has a value or a default of it: launch ends there",
        remedy=f"declare {name} with a default, or give it",
    )


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
    title="A launch argument is given to a file that does not know it, or used and never given",
    consequence="failure: likely",
    since="0.1.0",
    check=check,
)

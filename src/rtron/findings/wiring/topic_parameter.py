"""A parameter names a topic that nobody uses.

## What it finds

A parameter with `topic` in its name has a topic name as its value that no node uses, while one with
a near name is used.

For example, `path_topic` is `/opponent_controller/path`, and the app has `/controller/path`.

## What to do

Write the name that is used.

## When it is silent

Below the level `pedantic`, and where no used topic has a near name.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule
from rtron.findings.wiring_groups import WiringGroup, fact_finding, wiring_groups
from rtron.vocabulary import Certainty, Finding, WiringFactKind
from rtron.wording import join_names


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each parameter that names an unused topic."""
    for group in wiring_groups(app.graph, WiringFactKind.TOPIC_PARAMETER):
        yield _finding(group)


def _finding(group: WiringGroup) -> Finding:
    parameter, near = group.subject, join_names(group.others)
    return fact_finding(
        RULE.name,
        group,
        summary=f"the parameter {parameter} names {join_names(group.values)}, which nobody uses",
        cause=f"no node of this launch publishes or subscribes it; {near} is in use",
        remedy=f"did you mean {near}?",
        certainty=Certainty.POSSIBLE,
        topics=(*group.values, *group.others),
    )


RULE = FindingRule(
    name="topic_parameter",
    title="A parameter names a topic that nobody uses",
    consequence="failure: possible",
    since="0.1.0",
    check=check,
)

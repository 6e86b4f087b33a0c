"""A parameter names a topic that nobody uses.

## What it finds

A parameter with `topic` in its name and a whole topic name as its value, where no node of the app
uses that topic, while one with a near name is used.

## Why it matters

A node that uses the parameter gets no messages, or publishes for nobody.

## Remedy

Write the name that is used.

## Example

`path_topic` is `/opponent_controller/path`, and the app has `/controller/path`.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import (
    Certainty,
    Consequence,
    Finding,
    FindingLevel,
    UnresolvedItem,
)
from rtron.vocabulary.causes import UNUSED_TOPIC


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each parameter that names an unused topic."""
    for note in app.graph.unresolved:
        if note.why.startswith(UNUSED_TOPIC):
            yield _finding(note)


def _finding(note: UnresolvedItem) -> Finding:
    parameter, _, topic = note.what.removeprefix("parameter ").partition(" is ")
    near = note.why.rpartition(" ")[2]
    return make_finding(
        RULE.name,
        parameter,
        summary=f"the parameter {parameter} names {topic}, which nobody uses",
        cause=f"no node of this launch publishes or subscribes it; {near} is in use",
        remedy=f"did you mean {near}?",
        consequence=Consequence.FAILURE,
        certainty=Certainty.POSSIBLE,
        level=FindingLevel.PEDANTIC,
        topics=(topic, near),
        evidence=note.evidence,
    )


RULE = FindingRule(
    name="topic_parameter",
    title="A parameter names a topic that nobody uses",
    consequence="failure: possible",
    since="0.2.0",
    check=check,
)

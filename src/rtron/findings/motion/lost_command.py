"""A motion command reaches nobody.

## What it finds

A topic that commands motion, that nobody subscribes, while a topic of the same name and type is
obeyed in a namespace above or below: one of the two was left out of a remap. Where every node was
read, a topic beside it whose name says more or less (`control_mode`, `offboard_control_mode`)
counts, too. Who obeys the one and publishes the other forwards it, and does not count, nor where
other nodes stand between; nor does a topic that a subscription of a name known in part may mean,
nor one that by its name or its type is measured or estimated.
What may be an input of the autopilot PX4 (`/fmu/in/…`) is `pedantic`.

## Why it matters

What the node commands never happens: a recovery that should free the robot, a stop that should hold
it. No node fails, and the log says nothing.

## Remedy

Remap the topic to the one that is obeyed.

## Example

`/behavior_server` publishes `/cmd_vel`, and `/driver` obeys `/stretch/cmd_vel`.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts, says_more
from rtron.findings.inventory.things import is_harmless
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import Certainty, Consequence, Direction, Finding, FindingLevel
from rtron.wording import conjugate, join_names


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each motion topic without a reader whose namesake has one."""
    for topic in app.motion_topics:
        if obeyed := obeyed_instead(app, topic):
            yield _finding(app, topic, obeyed)


def obeyed_instead(app: AppFacts, topic: str) -> str:
    """Return the obeyed topic that one without a subscriber likely means; nothing if none."""
    is_measured = is_harmless(topic, app.facts.topic(topic).type)
    if is_measured or app.graph.subscribers(topic) or not app.publishers(topic) or "{" in topic:
        return ""
    return next((other for other in app.obeyed_topics if _is_meant(app, topic, other)), "")


def _is_meant(app: AppFacts, lost: str, obeyed: str) -> bool:
    """Return whether two topics differ in a namespace alone, or in a word where all was read."""
    (namespace, _, name), (other_namespace, _, other_name) = (
        each.rpartition("/") for each in (lost, obeyed)
    )
    if name == other_name:
        outer, inner = sorted((f"{namespace}/", f"{other_namespace}/"), key=len)
        is_namesake = outer != inner and inner.startswith(outer)
    else:
        is_namesake = namespace == other_namespace and says_more(name, other_name) and app.is_whole
    if not is_namesake:
        return False
    sent, expected = app.types(lost, Direction.PUBLISH), app.types(obeyed, Direction.SUBSCRIBE)
    publishers = set(app.publishers(lost))
    publishes_both = publishers <= set(app.publishers(obeyed))
    if publishes_both or app.open_readers(lost) or not sent.keys() & expected.keys():
        return False
    return obeyed not in app.upstream_topics(publishers, sent.keys())


def _finding(app: AppFacts, topic: str, obeyed: str) -> Finding:
    publishers, readers = app.publishers(topic), app.readers(obeyed)
    maybe_read = app.may_have_other_end(topic, Direction.SUBSCRIBE)
    return make_finding(
        RULE.name,
        topic,
        summary=f"what {join_names(publishers)} {conjugate(publishers, 'command')} on {topic} "
        "reaches nobody",
        cause=f"no node of this launch subscribes it{app.unread_hint}; "
        f"{join_names(readers)} {conjugate(readers, 'obey')} {obeyed}",
        remedy=f"remap {topic} to {obeyed}",
        consequence=Consequence.FAILURE,
        certainty=Certainty.POSSIBLE if maybe_read else Certainty.LIKELY,
        level=FindingLevel.PEDANTIC if maybe_read else FindingLevel.REGULAR,
        nodes=(*publishers, *readers),
        topics=(topic, obeyed),
        evidence=app.evidence(app.graph.publishers(topic)),
    )


RULE = FindingRule(
    name="lost_command",
    title="A motion command reaches nobody",
    consequence="failure: likely, possible where something was not read",
    since="0.2.0",
    check=check,
)

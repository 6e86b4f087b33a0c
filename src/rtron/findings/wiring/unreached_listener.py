"""A remap of /tf does not reach a transform listener.

## What it finds

A component's remap moves `/tf` or `/tf_static`, but its TransformListener is a node of its own
(`TransformListener(buffer)`), which the remap does not reach. Each transform fails, or is another
robot's.

For example, `/left/tool_pose` remaps `/tf_static` to `/left/tf_static`; its listener subscribes
`/tf_static`.

## What to do

Give the listener the component's node, `TransformListener(buffer, node)`, or write the remap at the
container, too.

## When it is silent

Below `pedantic` where no node of the launch publishes the remapped topic.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule
from rtron.findings.wiring_groups import WiringGroup, fact_finding, wiring_groups
from rtron.vocabulary import Certainty, Finding, WiringFactKind
from rtron.wording import conjugate, join_names


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each node whose remap of transforms its listener does not get."""
    for group in wiring_groups(app.graph, WiringFactKind.UNREACHED_LISTENER):
        yield _finding(app, group)


def _finding(app: AppFacts, group: WiringGroup) -> Finding:
    sent = [topic for topic in group.values if app.publishers(topic)]
    names = join_names(group.values)
    senders = sorted({node for topic in sent for node in app.publishers(topic)})
    hint = f"; {join_names(senders)} {conjugate(senders, 'send')} {join_names(sent)}"
    return fact_finding(
        RULE.name,
        group,
        summary=f"the transform listener of {group.subject} does not get {names}",
        cause="it is a node of its own, which remaps of a component do not reach: it subscribes "
        f"{join_names(group.others)}{hint if sent else ''}",
        remedy="give the listener the component's node, or remap at the container, too",
        certainty=Certainty.LIKELY if sent else Certainty.POSSIBLE,
        nodes=(group.subject,),
        topics=(*group.values, *group.others),
    )


RULE = FindingRule(
    name="unreached_listener",
    title="A remap of /tf does not reach a transform listener",
    consequence="failure: likely, possible where nobody publishes the remapped topic",
    since="0.1.0",
    check=check,
)

"""A frame that is used is in no transform.

## What it finds

A frame that a node looks up, or writes into the header of its messages, and that no transform of
the launch has. Whoever transforms them waits in vain: no map, no obstacles. The finding names a
near frame, if there is one. In ROS 2 a slash before a frame counts, too.

For example, the driver of a laser stamps its scans with `pico_1`; the static transform is for
`pico`.

## What to do

Give the messages, or the look-up, and the transform one name.

## When it is silent

Where a transform is not known, or transforms go to several topics. It is `pedantic` for a look-up
without a near frame, where something was not read, and for messages that nobody needs to transform.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule
from rtron.findings.wiring_groups import WiringGroup, fact_finding, wiring_groups
from rtron.vocabulary import Certainty, Endpoint, Finding, WiringFactKind
from rtron.vocabulary.names import TRANSFORM_TOPICS
from rtron.wording import conjugate, join_names

_LOOKED_UP = {
    WiringFactKind.MISSING_FRAME: Certainty.LIKELY,
    WiringFactKind.POSSIBLE_MISSING_FRAME: Certainty.POSSIBLE,
}
_PLAIN = ("std_msgs/", "std_srvs/")
"""Types without a header."""


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each frame that is in no transform: of messages, else of look-ups."""
    listeners = _listeners(app)
    stray = list(wiring_groups(app.graph, WiringFactKind.STRAY_FRAME)) if app.is_whole else []
    for group in stray:
        is_transformed = any(_are_transformed(app, sender, listeners) for sender in group.others)
        yield _finding(group, is_transformed=is_transformed)
    stamped = {group.subject for group in stray}
    for kind, certainty in _LOOKED_UP.items():
        for group in wiring_groups(app.graph, kind):
            is_whole = app.is_whole or _is_slash_too_much(group)
            if group.subject not in stamped:
                yield _missing(app, group, certainty if is_whole else Certainty.POSSIBLE)


def _are_transformed(app: AppFacts, sender: str, listeners: set[str]) -> bool:
    """Return whether each topic of a sender that others read is read by one with transforms."""
    sent = {end.topic for end in app.graph.published_by(sender) if _may_have_frame(end)}
    readers = [set(app.readers(topic)) - {sender} for topic in sent]
    return any(readers) and all(not each or each & listeners for each in readers)


def _may_have_frame(end: Endpoint) -> bool:
    return not (end.implicit or end.type.startswith(_PLAIN) or end.topic in TRANSFORM_TOPICS)


def _listeners(app: AppFacts) -> set[str]:
    """Return the nodes that listen to transforms, or whose listener is a node beside them.

    A process that is no node is named by the launch, and its node by its source. Of a container it
    is not known whose listener it is.
    """
    nodes = {end.node for topic in TRANSFORM_TOPICS for end in app.graph.subscribers(topic)}
    processes = {app.nodes[node].process for node in nodes & app.nodes.keys()} - {""}
    beside = {each.name for each in app.graph.nodes if each.process in processes - app.nodes.keys()}
    return nodes | processes | beside


def _finding(group: WiringGroup, *, is_transformed: bool) -> Finding:
    near = group.values[0]
    return fact_finding(
        RULE.name,
        group,
        summary=f"{join_names(group.others)} {conjugate(group.others, 'send')} messages in the "
        f"frame {group.subject}, which is in no transform",
        cause=f"the transforms of this launch have {near}",
        remedy=f"did you mean {near}? Give the messages and the transform one name",
        certainty=Certainty.LIKELY if is_transformed else Certainty.POSSIBLE,
        meant=near,
        nodes=group.others,
    )


def _missing(app: AppFacts, group: WiringGroup, certainty: Certainty) -> Finding:
    near, nodes = group.values[0], group.others
    known = f"the transforms of this launch have {near}" if near else "no node of this launch does"
    return fact_finding(
        RULE.name,
        group,
        summary=f"{join_names(nodes)} {conjugate(nodes, 'look')} up the frame {group.subject}, "
        "which nobody broadcasts",
        cause=f"tf2 takes no frame with a slash before it; {known}"
        if _is_slash_too_much(group)
        else f"{known}{app.unread_hint}",
        remedy=f"did you mean {near}? Give the look-up and the transform one name"
        if near
        else f"start what broadcasts {group.subject}",
        certainty=certainty,
        meant=near,
        nodes=nodes,
    )


def _is_slash_too_much(group: WiringGroup) -> bool:
    return group.subject == f"/{group.values[0]}"


RULE = FindingRule(
    name="stray_frame",
    title="A frame that is used is in no transform",
    consequence="failure: likely where it is looked up and a near one is there, else possible",
    since="0.1.0",
    check=check,
)

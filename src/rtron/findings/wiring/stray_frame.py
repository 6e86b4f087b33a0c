"""A frame that is used is in no transform.

## What it finds

A frame that a node looks up, and that no transform of the launch has: a text that the source gives
tf or tf2 (`lookupTransform`, `can_transform`, `transformPose` and others), or a parameter of a node
that RTron has a model of, such as `robot_base_frame` of Nav2. The finding names a near frame that a
transform has; so it does for `base_link` and `base_footprint`, if other frames are below the one
that is there. Without a near one another launch may send the transform, and the level is
`pedantic`.

A frame that the source of a node writes into the header of a message (`header.frame_id`), or into
`child_frame_id` of an odometry, as a constant or from parameters with the values of the launch, and
that no transform of the launch has, where a near one is there: with a suffix, a prefix or a
namespace more or less, with the words in another order, or a few letters off. In ROS 2 so is a
frame with a slash before it, which tf2 does not take. In ROS 1 a transform may have the frame below
a prefix, as `tf_prefix` makes it.

All transforms must be known: those of broadcasters in source, of `static_transform_publisher`, of
the robot description and of the nodes that RTron has models of. Where one is not, or where
transforms go to several topics, the rule is silent. Where a node or a file was not read, it may
send the transform: what is looked up is `pedantic` then, and messages are not looked at. A
slash before a frame that tf2 looks up is too much whoever sends the transform.

A frame of messages is shown at the default level where each topic of a sender that others read has
a reader that listens to transforms. Who works with the messages alone needs no frame: else the
level is `pedantic`.

## Why it matters

Whoever transforms the messages waits for a transform that never comes, and drops them: no map, no
obstacles, a fused pose without the sensor. A look-up fails each time.

## Remedy

Give the messages, or the look-up, and the transform one name.

## Example

The driver of a laser stamps its scans with `pico_1`; the static transform is for `pico`.
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
        nodes=nodes,
    )


def _is_slash_too_much(group: WiringGroup) -> bool:
    return group.subject == f"/{group.values[0]}"


RULE = FindingRule(
    name="stray_frame",
    title="A frame that is used is in no transform",
    consequence="failure: likely where it is looked up and a near one is there, else possible",
    since="0.2.0",
    check=check,
)

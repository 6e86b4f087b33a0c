"""A node subscribes a topic that nobody publishes, and a near name is published.

## What it finds

A topic has a subscriber and no publisher, and another topic of its type has a near name: a remap, a
namespace or a typo parts the two. The subscriber waits for ever.

For example, `/nav` subscribes `/odometry/filterd`, and `/ekf` publishes `/odometry/filtered`.

## What to do

Find out who should publish the topic. Where the finding is likely and the names say the same, remap
one to the other; never a command or a stop, which may be meant for another robot.

## When it is silent

For inputs that are options, such as a pose to start from. It is `pedantic` where something was not
read, or others subscribe the near name and the reader is not in a namespace of its own name, as a
costmap is. See also `lost_command` and `incomplete_launch`.
"""

from collections.abc import Iterator, Mapping
from functools import lru_cache

from rtron.findings.app_facts import AppFacts
from rtron.findings.lost_commands import lost_commands
from rtron.findings.measurement_names import MEASURED_TYPES
from rtron.findings.near_names import near_names, says_more
from rtron.findings.node_kinds import is_one_stack
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import (
    ROS2_ACTION_TOPICS,
    Certainty,
    Consequence,
    Direction,
    Finding,
    FindingLevel,
    InteractionGraph,
    Ros1ActionTopic,
    ros1_topic_name,
    ros2_entity_name,
)
from rtron.vocabulary.names import are_nested
from rtron.wording import conjugate, join_names

_RECORDER_PACKAGE = "ros2bag"


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each topic that is subscribed, while a near one is published."""
    for topic, near in {**unmatched_topics(app), **_recorded(app)}.items():
        if near:
            yield _finding(app, topic, near, app.readers(topic) or _recorders(app, topic))


def _recorders(app: AppFacts, topic: str) -> tuple[str, ...]:
    """Return the nodes that write a topic to a bag."""
    nodes = (app.nodes.get(end.node) for end in app.graph.subscribers(topic) if not end.implicit)
    return tuple(each.name for each in nodes if each and each.package == _RECORDER_PACKAGE)


def _recorded(app: AppFacts) -> dict[str, list[str]]:
    """Return the topics that are only recorded and not published, each with the near ones.

    What is recorded beside it is not meant.
    """
    types = {type for topic in app.explicit_topics for type in app.types(topic, Direction.PUBLISH)}
    topics = (each for each in app.explicit_topics if not _has_other_end(app, each))
    near = {each: app.near_topics(each, types) for each in topics if _recorders(app, each)}
    return {
        topic: [other for other in others if not _recorders(app, other)]
        for topic, others in near.items()
    }


@lru_cache(maxsize=1)
def unmatched_topics(app: AppFacts) -> Mapping[str, list[str]]:
    """Return the topics that are subscribed and not published, each with the near ones."""
    others = {*_action_topics(app.graph), *lost_commands(app).values()}
    topics = (each for each in app.explicit_topics if _is_unmatched(app, each))
    return {topic: _near(app, topic) for topic in topics if topic not in others}


def _near(app: AppFacts, topic: str) -> list[str]:
    return [
        other
        for other in app.near_topics(topic, app.types(topic, Direction.SUBSCRIBE))
        if not is_one_stack(app, (*app.readers(topic), *app.publishers(other)))
        and not (is_option(app, topic) and _is_other_word(topic, other))
    ]


def is_option(app: AppFacts, topic: str) -> bool:
    """Return whether a topic is no measurement, and only nodes from elsewhere subscribe it."""
    is_own = any(app.facts.are_own([reader]) for reader in app.readers(topic))
    return not (is_own or MEASURED_TYPES.match(app.facts.topic(topic).type))


def _is_other_word(topic: str, other: str) -> bool:
    return says_more(*(name.rpartition("/")[2] for name in (topic, other)))


def _action_topics(graph: InteractionGraph) -> Iterator[str]:
    """Yield the topics of the actions: `no_server` tells of one without a server."""
    for action in graph.actions:
        yield from (ros1_topic_name(action.name, part) for part in Ros1ActionTopic)
        yield from (ros2_entity_name(action.name, part) for part in ROS2_ACTION_TOPICS)


def _is_unmatched(app: AppFacts, topic: str) -> bool:
    is_for_logs = app.facts.lists.ignores_topic(topic)
    return not (_has_other_end(app, topic) or is_for_logs) and bool(app.readers(topic))


def _has_other_end(app: AppFacts, topic: str) -> bool:
    """Return whether a topic is published, as is one whose name is known in part, or hidden."""
    is_part_missing = "{" in topic or topic.rpartition("/")[2].startswith("_")
    return is_part_missing or bool(app.publishers(topic))


def _finding(app: AppFacts, topic: str, near: list[str], readers: tuple[str, ...]) -> Finding:
    maybe_elsewhere = app.may_have_other_end(topic, Direction.PUBLISH)
    unread_near = [
        other for other in near if not app.readers(other) or _is_meant(other, topic, readers)
    ]
    is_likely = bool(unread_near) and not maybe_elsewhere
    publishers = app.publishers(near[0])
    is_doubtful = app.is_motion(topic) or app.is_stop(topic) or _is_other_word(topic, near[0])
    is_doubtful |= not near_names(topic, near[:1]) and not are_nested(topic, near[0])
    return make_finding(
        RULE.name,
        topic,
        summary=f"{join_names(readers)} {conjugate(readers, 'subscribe')} {topic}, "
        "which nobody publishes",
        cause=f"no node of this launch publishes it{app.unread_publisher_hint([topic])}; "
        f"{join_names(publishers)} {conjugate(publishers, 'send')} {near[0]}",
        remedy=f"did you mean {near[0]}? Remap one to the other"
        if is_likely and not is_doubtful
        else f"find out who should publish {topic}; {near[0]} may be another thing",
        consequence=Consequence.FAILURE,
        certainty=Certainty.LIKELY if is_likely else Certainty.POSSIBLE,
        level=FindingLevel.REGULAR if is_likely else FindingLevel.PEDANTIC,
        meant=near[0],
        nodes=readers,
        topics=(topic, near[0]),
        evidence=app.evidence(app.graph.subscribers(topic)),
    )


def _is_meant(other: str, topic: str, readers: tuple[str, ...]) -> bool:
    """Return whether readers in namespaces of their own names likely mean the topic above it.

    A costmap of Nav2 is `/local_costmap/local_costmap`: its relative names lie below that.
    """
    above, _, name = other.rpartition("/")
    own = [reader.rpartition("/") for reader in readers]
    return bool(own) and all(
        namespace == f"{above}/{node}" and topic == f"{namespace}/{name}"
        for namespace, _, node in own
    )


RULE = FindingRule(
    name="unmatched_topic",
    title="A node subscribes a topic that nobody publishes, and a near name is published",
    consequence="failure: likely where nobody subscribes the near name, else possible",
    since="0.1.0",
    check=check,
)

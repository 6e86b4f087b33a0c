"""Several nodes publish one topic.

## What it finds

A topic has more than one publisher and at least one node that acts on it (paper section 4.1;
Algorithm 1, lines 1 to 3). Whoever publishes last decides. The high-risk nodes are the publishers.
The goals of a ROS 2 action count as a topic.

For example, `/move_base` and `/teleop_twist_keyboard` publish `/cmd_vel`, which `/gazebo` obeys.

## What to do

Put a GRCN between the publishers and the successors. For velocities choose Preemption, for goals
FIFO_Queue or Priority_Queue. Where each publisher owns a part of the topic, as of `/tf`, observe it
and block whom you do not know.

## When it is silent

For logs and visualisation. A node that only records or shows (rviz, rosbag, rqt) counts as a
publisher, not as a successor.
"""

from collections.abc import Iterator

from rtron.risks.graph_facts import GraphFacts, TopicFacts, evidence_of
from rtron.risks.rule import RiskRule, RuleInput
from rtron.risks.severity import contends_for_robot, severity_of
from rtron.vocabulary import Risk, RiskKind, RiskRole, Sharing, TopicClass
from rtron.wording import both_or_all, conjugate, join_names


def check(facts: GraphFacts) -> Iterator[Risk]:
    """Yield a risk for each topic with several publishers and a successor."""
    for topic in map(facts.topic, (*facts.published_topics, *facts.ros2_actions)):
        if len(topic.publishers) > 1 and topic.successors and not _ignored(facts, topic):
            yield _risk(facts, topic)


def _ignored(facts: GraphFacts, topic: TopicFacts) -> bool:
    ignores_type = facts.lists.ignores_type
    return facts.lists.ignores_topic(topic.name) or any(map(ignores_type, topic.types))


def _risk(facts: GraphFacts, topic: TopicFacts) -> Risk:
    topic_class = facts.classify(topic.name)
    moves = contends_for_robot(topic_class)
    return Risk(
        id=f"GR-ST:{topic.name}",
        kind=RiskKind.GR_ST,
        rule=RULE.name,
        role_nodes={RiskRole.PUBLISHER: topic.publishers},
        topics=(topic.name,),
        message_type=topic.type,
        successors=topic.successors,
        domain=topic_class.domain,
        severity=severity_of(
            moves_robot=moves, only_own_nodes=topic.only_own_publishers, reaches_successor=True
        ),
        reason=_reason(topic, topic_class),
        evidence=evidence_of(facts.graph_with_goals.publishers(topic.name)),
    )


def _reason(topic: TopicFacts, topic_class: TopicClass) -> str:
    subject = f"{join_names(topic.publishers)} {both_or_all(topic.publishers)} publish {topic.name}"
    successors = join_names(topic.successors)
    if topic_class.sharing is Sharing.MERGE:
        return f"{subject}: each could overwrite what the others tell {successors}"
    return f"{subject}: {successors} {conjugate(topic.successors, 'follow')} whoever spoke last"


RULE = RiskRule(
    name="gr_st",
    kind=RiskKind.GR_ST,
    title="General risk with a single topic",
    severity="high where an untrusted node contends for a topic of Planning or Control, "
    "else medium; one step milder when all publishers are your own",
    needs=(RuleInput.PUBLISHERS, RuleInput.SUBSCRIBERS),
    since="0.1.0",
    check=check,
)

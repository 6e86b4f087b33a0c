"""Nodes tell what happens around the robot.

## What it finds

A topic has the message type of an event (battery, temperature, position and others), or `detect` in
its name (paper section 4.3; Algorithm 1, lines 6 to 8). Its publishers, the high-risk nodes, can
invent an event or withhold it, so that the robot breaks a rule of its mission.

For example, `/gazebo` publishes `/odom` of type `nav_msgs/Odometry`: where the robot is.

## What to do

Use an MSRCN that listens to the event and blocks the actions that the rule forbids. Choose for each
rule what silence means: where the event must not be missed, silence blocks too.

## When it is silent

For your own Preprocessing nodes that forward images, scans, clouds or inertial data.
"""

from collections.abc import Iterator

from rtron.risks.graph_facts import GraphFacts, TopicFacts, evidence_of
from rtron.risks.rule import RiskRule, RuleInput
from rtron.risks.severity import severity_of
from rtron.vocabulary import FunctionType, Risk, RiskKind, RiskRole, Trust
from rtron.wording import conjugate, join_names


def check(facts: GraphFacts) -> Iterator[Risk]:
    """Yield a risk for each topic that tells an event."""
    preprocessing = _preprocessing(facts)
    for topic in map(facts.topic, facts.published_topics):
        if _is_event(facts, topic):
            left_out = preprocessing if _is_preprocessed(facts, topic) else ()
            nodes = tuple(node for node in topic.publishers if node not in left_out)
            if nodes:
                yield _risk(facts, topic, nodes)


def _is_event(facts: GraphFacts, topic: TopicFacts) -> bool:
    return facts.lists.names_event(topic.name) or any(map(facts.lists.is_event, topic.types))


def _is_preprocessed(facts: GraphFacts, topic: TopicFacts) -> bool:
    return bool(topic.types) and all(map(facts.lists.is_preprocessed, topic.types))


def _preprocessing(facts: GraphFacts) -> frozenset[str]:
    nodes = facts.graph.nodes
    converting = (n for n in nodes if n.function is FunctionType.PREPROCESSING)
    return frozenset(node.name for node in converting if node.trust is Trust.OWN)


def _risk(facts: GraphFacts, topic: TopicFacts, nodes: tuple[str, ...]) -> Risk:
    endpoints, publishers = facts.graph.publishers(topic.name), frozenset(nodes)
    return Risk(
        id=f"MSR-event:{topic.name}",
        kind=RiskKind.MSR,
        rule=RULE.name,
        role_nodes={RiskRole.EVENT: nodes},
        topics=(topic.name,),
        message_type=topic.type,
        successors=topic.successors,
        domain=facts.classify(topic.name).domain,
        severity=severity_of(
            moves_robot=False,
            only_own_nodes=facts.are_own(nodes),
            reaches_successor=bool(topic.successors),
        ),
        reason=(
            f"{join_names(nodes)} {conjugate(nodes, 'tell')} on {topic.name} what happens: "
            f"a rule that relies on it is as good as {join_names(nodes)}"
        ),
        evidence=evidence_of(e for e in endpoints if e.node in publishers),
    )


RULE = RiskRule(
    name="msr_event",
    kind=RiskKind.MSR,
    title="Mission-specific risk of an event",
    severity="medium where a publisher is untrusted, low where all are your own or no node acts "
    "on the event",
    needs=(RuleInput.PUBLISHERS, RuleInput.TYPES),
    since="0.1.0",
    check=check,
)

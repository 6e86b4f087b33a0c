"""Nodes tell what happens around the robot.

## What it finds

A topic whose message type is an event (battery, temperature, position and others: EVENT_MSG_TYPE),
or with `detect` in its name (mission-specific risk, paper section 4.3; Algorithm 1, lines 6 to 8).
The high-risk nodes are its publishers. The paper's text leaves out nodes of Preprocessing; here
your own are left out, where they hand on images, scans, clouds or inertial data. A node's function
is often told by a name, which anybody can choose: so a stranger's node counts, and so does
whatever tells more than such data.

## Why it is a risk

The rules of a mission speak of events: while somebody sleeps, do not clean; at a red light, stop.
A node that invents an event, or keeps one to itself, makes the robot break the rule without any
other node being at fault.

## Remedy

An MSRCN that listens to the event and blocks the actions which the rule forbids while it lasts.
Choose for each rule what silence means: where the event must not be missed, silence blocks too.

## Example

`/gazebo` publishes `/odom` of type `nav_msgs/Odometry`: where the robot is.
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

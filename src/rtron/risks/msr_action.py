"""Nodes make the robot act.

## What it finds

A topic has the message type of an action of a base, a manipulator or a speaker, or `goal` in its
name (paper section 4.3; Algorithm 1, lines 9 to 11). What is harmless at one place and time breaks
the mission's rules at another. The high-risk nodes are the publishers, of a ROS 2 action its
clients.

For example, `/detect_tunnel` publishes `/cmd_vel` of type `geometry_msgs/Twist`, which `/gazebo`
obeys.

## What to do

Put an MSRCN before the actuators that blocks the action while an event of the mission forbids it.

## When it is silent

For an action's feedback and result, which only answer.
"""

from collections.abc import Iterator

from rtron.risks.graph_facts import GraphFacts, TopicFacts, evidence_of
from rtron.risks.rule import RiskRule, RuleInput
from rtron.risks.severity import severity_of
from rtron.vocabulary import Risk, RiskKind, RiskRole
from rtron.wording import conjugate, join_names


def check(facts: GraphFacts) -> Iterator[Risk]:
    """Yield a risk for each topic that makes the robot act, and for each action of ROS 2."""
    for topic in map(facts.topic, facts.published_topics):
        if _acts(facts, topic):
            yield _risk(facts, topic)
    yield from (_risk(facts, facts.topic(name)) for name in facts.ros2_actions)


def _acts(facts: GraphFacts, topic: TopicFacts) -> bool:
    answers = facts.lists.action_answer
    if topic.name.endswith(answers) or any(name.endswith(answers) for name in topic.types):
        return False
    return facts.lists.names_action(topic.name) or any(map(facts.lists.is_action, topic.types))


def _risk(facts: GraphFacts, topic: TopicFacts) -> Risk:
    nodes, successors = topic.publishers, topic.successors
    return Risk(
        id=f"MSR-action:{topic.name}",
        kind=RiskKind.MSR,
        rule=RULE.name,
        role_nodes={RiskRole.ACTION: nodes},
        topics=(topic.name,),
        message_type=topic.type,
        successors=successors,
        domain=facts.classify(topic.name).domain,
        severity=severity_of(
            moves_robot=True,
            only_own_nodes=topic.only_own_publishers,
            reaches_successor=bool(successors),
        ),
        reason=(
            f"{join_names(nodes)} {conjugate(nodes, 'make')} the robot act through {topic.name}: "
            f"{join_names(successors, 'no node so far')} {conjugate(successors, 'obey')}, "
            "whatever happens"
        ),
        evidence=evidence_of(facts.graph_with_goals.publishers(topic.name)),
    )


RULE = RiskRule(
    name="msr_action",
    kind=RiskKind.MSR,
    title="Mission-specific risk of an action",
    severity="high where a publisher is untrusted, medium where all are your own; low while no "
    "node obeys",
    needs=(RuleInput.PUBLISHERS, RuleInput.TYPES),
    since="0.1.0",
    check=check,
)

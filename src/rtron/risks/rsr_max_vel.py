"""A node sets the maximal velocity.

## What it finds

A topic of type `std_msgs/Float64` has `max_vel` in its name (paper section 4.2; Algorithm 1, lines
4 and 5). Its publishers, the high-risk nodes, can make the robot faster than its recognition can
follow.

For example, `/detect_parking` publishes `/control/max_vel`, which `/control_lane` obeys.

## What to do

Put an RSRCN between these publishers and the nodes that obey them: Safe ties the limit to the frame
rate, Constrain to a value of yours, Block silences one publisher.

## When it is silent

For other types and names: add yours with `--name-lists`.
"""

from collections.abc import Iterator

from rtron.risks.graph_facts import GraphFacts, TopicFacts, evidence_of
from rtron.risks.rule import RiskRule, RuleInput
from rtron.risks.severity import severity_of
from rtron.vocabulary import Risk, RiskKind, RiskRole
from rtron.wording import conjugate, join_names


def check(facts: GraphFacts) -> Iterator[Risk]:
    """Yield a risk for each published topic that sets the maximal velocity."""
    for topic in map(facts.topic, facts.published_topics):
        if any(facts.lists.is_max_vel(name, topic.name) for name in topic.types):
            yield _risk(facts, topic)


def _risk(facts: GraphFacts, topic: TopicFacts) -> Risk:
    publishers, successors = topic.publishers, topic.successors
    return Risk(
        id=f"RSR-max_vel:{topic.name}",
        kind=RiskKind.RSR,
        rule=RULE.name,
        role_nodes={RiskRole.MAX_VEL: publishers},
        topics=(topic.name,),
        message_type=topic.type,
        successors=successors,
        domain=facts.classify(topic.name).domain,
        severity=severity_of(
            moves_robot=True,
            only_own_nodes=topic.only_own_publishers,
            reaches_successor=bool(successors),
        ),
        reason=f"{join_names(publishers)} {conjugate(publishers, 'set')} on {topic.name} how fast "
        f"{join_names(successors, 'nobody so far')} may drive, whatever the cameras can follow",
        evidence=evidence_of(facts.graph.publishers(topic.name)),
    )


RULE = RiskRule(
    name="rsr_max_vel",
    kind=RiskKind.RSR,
    title="Robot-specific risk of a maximal velocity",
    severity="high where a publisher is untrusted, medium where all are your own; low while no "
    "node obeys",
    needs=(RuleInput.PUBLISHERS, RuleInput.TYPES),
    since="0.1.0",
    check=check,
)

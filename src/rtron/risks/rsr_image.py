"""A node recognises things in images.

## What it finds

A node subscribes `sensor_msgs/Image` or `CompressedImage`, and publishes a topic named like a
recognition: `detect`, `people`, `face`, `object` and others (paper section 4.2; Algorithm 1, lines
17 to 22). If it slows down, a safe speed is no longer safe.

For example, `/detect_sign` subscribes `/camera/image_compensated` and publishes
`/detect/traffic_sign`.

## What to do

Use an fps_monitor that measures the node's frame rate, and an RSRCN that keeps the velocity below
what this rate allows (Safe), or below a limit of yours (Constrain).

## When it is silent

Where no name of an output is in `recog_topic_name`: add yours with `--name-lists`.
"""

from collections.abc import Iterator

from rtron.risks.graph_facts import MAX_NAMED_NODES, GraphFacts, evidence_of
from rtron.risks.rule import RiskRule, RuleInput
from rtron.risks.severity import severity_of
from rtron.vocabulary import Endpoint, Risk, RiskKind, RiskRole
from rtron.wording import join_names


def check(facts: GraphFacts) -> Iterator[Risk]:
    """Yield a risk for each node that takes images and tells what it recognises."""
    for node in facts.subscribing_nodes:
        images = [e for e in facts.graph.subscribed_by(node) if _is_image(facts, e)]
        recognitions = _recognitions(facts, node) if images else ()
        if recognitions:
            yield _risk(facts, images, recognitions)


def _is_image(facts: GraphFacts, endpoint: Endpoint) -> bool:
    return facts.lists.is_image(facts.type_of(endpoint))


def _recognitions(facts: GraphFacts, node: str) -> tuple[str, ...]:
    topics = {endpoint.topic for endpoint in facts.graph.published_by(node)}
    words = facts.lists.recog_topic_name
    return tuple(sorted(topic for topic in topics if any(word in topic for word in words)))


def _risk(facts: GraphFacts, images: list[Endpoint], recognitions: tuple[str, ...]) -> Risk:
    node = images[0].node
    successors = tuple(
        sorted(
            {n for topic in recognitions for n in facts.topic(topic).successors[:MAX_NAMED_NODES]}
        )
    )
    return Risk(
        id=f"RSR-image:{node}",
        kind=RiskKind.RSR,
        rule=RULE.name,
        role_nodes={RiskRole.IMAGE: (node,)},
        topics=recognitions,
        message_type=facts.type_of(images[0]),
        successors=successors,
        domain=facts.classify(recognitions[0]).domain,
        severity=severity_of(
            moves_robot=False,
            only_own_nodes=facts.are_own([node]),
            reaches_successor=bool(successors),
        ),
        reason=f"{node} recognises what is on {join_names(sorted({e.topic for e in images}))} and "
        f"tells it on {join_names(recognitions)}: if it slows down, the robot outruns its eyes",
        evidence=evidence_of(images),
    )


RULE = RiskRule(
    name="rsr_image",
    kind=RiskKind.RSR,
    title="Robot-specific risk of an image node",
    severity="medium where the node is untrusted, low where it is your own or no node acts on "
    "what it tells",
    needs=(RuleInput.PUBLISHERS, RuleInput.SUBSCRIBERS, RuleInput.TYPES),
    since="0.1.0",
    check=check,
)

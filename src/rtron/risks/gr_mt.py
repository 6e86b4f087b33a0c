"""A node hears one type of message from several topics.

## What it finds

A node with two or more subscriptions of one message type (general risk with multiple topics, paper
section 4.1; Algorithm 1, lines 12 to 16). The high-risk nodes are the publishers of these topics;
the node itself is the successor. `TwistStamped` counts with `Twist`, and a type is the same in
both ROS spellings. Log and visualisation topics are left out, and so are nodes that only record or
show.

The paper narrows this to topics with one publisher and one subscriber, but its own example has four
publishers on one of the topics. So every such node is found, and the risk says `one_to_one` where
the narrow reading holds too.

## Why it is a risk

What arrives on parallel topics of one type mostly feeds one estimate or one decision: two images,
two statuses, two speeds. A false one is enough to bend the result, and the others cannot make up
for it.

## Remedy

A GRCN for each of the topics. Sensors and states are processed in parallel and need no turns:
observe them, and block one when it lies. Commands contend: give them priorities.

## Example

`/find_object_3d` takes `sensor_msgs/Image` from `/camera/rgb/image_raw` and
`/camera/depth/image_raw`.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from rtron.risks.graph_facts import NAMED, Facts, TopicFacts, evidence_of
from rtron.risks.rule import Need, Rule
from rtron.risks.severity import contends_for_robot, severity_of
from rtron.risks.wording import listed
from rtron.vocabulary import Domain, Endpoint, Risk, RiskKind, Role, Severity, without_stamp


@dataclass(frozen=True, slots=True, kw_only=True)
class _Parallel:
    """What holds for a set of topics, whoever subscribes them."""

    topics: tuple[str, ...]
    publishers: tuple[str, ...]
    domain: Domain
    severity: Severity
    one_to_one: bool


def check(facts: Facts) -> Iterator[Risk]:
    """Yield a risk for each node and type with several subscriptions."""
    known: dict[tuple[str, ...], _Parallel] = {}
    for message_type, heard in _heard(facts):
        names = tuple(sorted({endpoint.topic for endpoint in heard}))
        if len(names) > 1:
            # Half of the nodes of an app hear the same topics, /tf and /tf_static.
            parallel = known.get(names) or known.setdefault(names, _parallel(facts, names))
            yield _risk(message_type, parallel, heard)


def _heard(facts: Facts) -> Iterator[tuple[str, list[Endpoint]]]:
    for node in facts.subscribing:
        if node not in facts.viewers:
            yield from sorted(_by_type(facts, node).items())


def _by_type(facts: Facts, node: str) -> dict[str, list[Endpoint]]:
    heard: dict[str, list[Endpoint]] = defaultdict(list)
    for endpoint in facts.graph.subscribed_by(node):
        message_type = without_stamp(facts.type_of(endpoint))
        ignored = facts.lists.ignores_type(message_type) or facts.lists.ignores_topic(
            endpoint.topic
        )
        if message_type and not ignored:
            heard[message_type].append(endpoint)
    return heard


def _parallel(facts: Facts, names: tuple[str, ...]) -> _Parallel:
    topics = list(map(facts.topic, names))
    return _Parallel(
        topics=names,
        publishers=tuple(sorted({node for topic in topics for node in topic.publishers[:NAMED]})),
        domain=_domain(facts, names),
        severity=_severity(facts, topics),
        one_to_one=all(len(t.publishers) == 1 and len(t.successors) == 1 for t in topics),
    )


def _domain(facts: Facts, names: Sequence[str]) -> Domain:
    """Return the domain of most of the topics, of equals the one nearer to the actuators."""
    domains = [facts.classify(name).domain for name in names]
    candidates = [domain for domain in Domain if domain in domains]
    return max(reversed(candidates), key=lambda d: (domains.count(d), d is not Domain.OTHERS))


def _severity(facts: Facts, topics: Sequence[TopicFacts]) -> Severity:
    return severity_of(
        moves=any(contends_for_robot(facts.classify(topic.name)) for topic in topics),
        own=all(topic.own for topic in topics),
        reaches=any(topic.publishers for topic in topics),
    )


def _risk(message_type: str, parallel: _Parallel, heard: Sequence[Endpoint]) -> Risk:
    node, topics = heard[0].node, parallel.topics
    misleading = listed(parallel.publishers, "whoever publishes one")
    return Risk(
        id=f"GR-MT:{node}:{message_type}",
        kind=RiskKind.GR_MT,
        rule=RULE.name,
        role_nodes={Role.PUBLISHER: parallel.publishers},
        topics=topics,
        message_type=message_type,
        successors=(node,),
        domain=parallel.domain,
        severity=parallel.severity,
        reason=f"{node} takes {message_type} from {len(topics)} topics, {listed(topics)}: "
        f"{misleading} can mislead it on any of them",
        one_to_one=parallel.one_to_one,
        evidence=evidence_of(heard),
    )


RULE = Rule(
    name="gr_mt",
    kind=RiskKind.GR_MT,
    title="General risk with multiple topics",
    severity="high where an untrusted node publishes and one of the topics is contended for in "
    "Planning or Control, else medium; one step milder when all publishers are your own; low "
    "while nobody publishes",
    needs=(Need.SUBSCRIBERS, Need.TYPES),
    since="0.1.0",
    check=check,
)

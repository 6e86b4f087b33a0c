"""A node hears one type of message from several topics.

## What it finds

A node has two or more subscriptions of one message type (paper section 4.1; Algorithm 1, lines 12
to 16). They mostly feed one decision, so a false message on one is enough. The high-risk nodes are
the publishers. `one_to_one` says whether the paper's narrow reading (one publisher, one subscriber)
holds, too.

For example, `/find_object_3d` takes `sensor_msgs/Image` from `/camera/rgb/image_raw` and
`/camera/depth/image_raw`.

## What to do

Put a GRCN on each of the topics. Observe sensors and states, and block one when it lies. Give
commands priorities.

## When it is silent

For logs and visualisation, and for nodes that only record or show.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from rtron.risks.graph_facts import MAX_NAMED_NODES, GraphFacts, TopicFacts, evidence_of
from rtron.risks.rule import RiskRule, RuleInput
from rtron.risks.severity import contends_for_robot, severity_of
from rtron.vocabulary import Domain, Endpoint, Risk, RiskKind, RiskRole, Severity, unstamped_type
from rtron.wording import join_names


@dataclass(frozen=True, slots=True, kw_only=True)
class _ParallelTopics:
    """What holds for a set of topics, whoever subscribes them."""

    topics: tuple[str, ...]
    publishers: tuple[str, ...]
    domain: Domain
    severity: Severity
    one_to_one: bool


def check(facts: GraphFacts) -> Iterator[Risk]:
    """Yield a risk for each node and type with several subscriptions."""
    known: dict[tuple[str, ...], _ParallelTopics] = {}
    for message_type, endpoints in _subscriptions_by_type(facts):
        names = tuple(sorted({endpoint.topic for endpoint in endpoints}))
        if len(names) > 1:
            # Half of the nodes of an app hear the same topics, /tf and /tf_static.
            parallel = known.get(names) or known.setdefault(names, _parallel(facts, names))
            yield _risk(message_type, parallel, endpoints)


def _subscriptions_by_type(facts: GraphFacts) -> Iterator[tuple[str, list[Endpoint]]]:
    for node in facts.subscribing_nodes:
        if node not in facts.viewers:
            yield from sorted(_by_type(facts, node).items())


def _by_type(facts: GraphFacts, node: str) -> dict[str, list[Endpoint]]:
    endpoints: dict[str, list[Endpoint]] = defaultdict(list)
    for endpoint in facts.graph.subscribed_by(node):
        message_type = unstamped_type(facts.type_of(endpoint))
        ignored = facts.lists.ignores_type(message_type) or facts.lists.ignores_topic(
            endpoint.topic
        )
        if message_type and not ignored:
            endpoints[message_type].append(endpoint)
    return endpoints


def _parallel(facts: GraphFacts, names: tuple[str, ...]) -> _ParallelTopics:
    topics = list(map(facts.topic, names))
    return _ParallelTopics(
        topics=names,
        publishers=tuple(
            sorted({node for topic in topics for node in topic.publishers[:MAX_NAMED_NODES]})
        ),
        domain=_domain(facts, names),
        severity=_severity(facts, topics),
        one_to_one=all(len(t.publishers) == 1 and len(t.successors) == 1 for t in topics),
    )


def _domain(facts: GraphFacts, names: Sequence[str]) -> Domain:
    """Return the domain of most of the topics, of equals the one nearer to the actuators."""
    domains = [facts.classify(name).domain for name in names]
    candidates = [domain for domain in Domain if domain in domains]
    return max(reversed(candidates), key=lambda d: (domains.count(d), d is not Domain.OTHERS))


def _severity(facts: GraphFacts, topics: Sequence[TopicFacts]) -> Severity:
    return severity_of(
        moves_robot=any(contends_for_robot(facts.classify(topic.name)) for topic in topics),
        only_own_nodes=all(topic.only_own_publishers for topic in topics),
        reaches_successor=any(topic.publishers for topic in topics),
    )


def _risk(message_type: str, parallel: _ParallelTopics, endpoints: Sequence[Endpoint]) -> Risk:
    node, topics = endpoints[0].node, parallel.topics
    misleading = join_names(parallel.publishers, "whoever publishes one")
    return Risk(
        id=f"GR-MT:{node}:{message_type}",
        kind=RiskKind.GR_MT,
        rule=RULE.name,
        role_nodes={RiskRole.PUBLISHER: parallel.publishers},
        topics=topics,
        message_type=message_type,
        successors=(node,),
        domain=parallel.domain,
        severity=parallel.severity,
        reason=f"{node} takes {message_type} from {len(topics)} topics, {join_names(topics)}: "
        f"{misleading} can mislead it on any of them",
        one_to_one=parallel.one_to_one,
        evidence=evidence_of(endpoints),
    )


RULE = RiskRule(
    name="gr_mt",
    kind=RiskKind.GR_MT,
    title="General risk with multiple topics",
    severity="high where an untrusted node publishes and one of the topics is contended for in "
    "Planning or Control, else medium; one step milder when all publishers are your own; low "
    "while nobody publishes",
    needs=(RuleInput.SUBSCRIBERS, RuleInput.TYPES),
    since="0.1.0",
    check=check,
)

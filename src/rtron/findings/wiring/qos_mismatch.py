"""The QoS of two ends of a topic do not fit.

## What it finds

The QoS of a publisher and a subscription of one topic are incompatible (ROS 2). The middleware does
not connect them:

| policy | the publisher offers | the subscription requests |
|---|---|---|
| reliability | best effort | reliable |
| durability | volatile | transient local |
| deadline | none, or longer | shorter |
| liveliness | automatic | manual by topic |
| lease duration | none, or longer | shorter |

Or a publisher offers a deadline that its own timer does not hold: each time it is missed.

For example, a driver publishes `/scan` as sensor data (best effort), and a node subscribes it as
reliable.

## What to do

Let the publisher offer at least what the subscription requests, or the subscription request less.

## When it is silent

Where neither the source, a model nor the running app tells the QoS of an end.
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.findings.wiring_groups import fact_finding
from rtron.vocabulary import (
    Certainty,
    Durability,
    Endpoint,
    Finding,
    Liveliness,
    QoS,
    Reliability,
    WiringFact,
    WiringFactKind,
)
from rtron.wording import conjugate, join_names


class _Mismatch(NamedTuple):
    """Publishers with one QoS, subscriptions with one QoS, and in words why they do not fit."""

    publishers: list[Endpoint]
    subscribers: list[Endpoint]
    why: list[str]


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each topic with a publisher and a subscription that do not fit."""
    for topic in app.explicit_topics if app.graph.ros != 1 else ():
        received = _by_qos(app.graph.subscribers(topic))
        mismatches = [
            _Mismatch(publishers, subscribers, why)
            for offered, publishers in _by_qos(app.graph.publishers(topic)).items()
            for requested, subscribers in received.items()
            if (why := incompatibilities(offered, requested))
        ]
        if mismatches:
            yield _finding(app, topic, mismatches)
    yield from (_slow(f) for f in app.graph.wiring if f.kind is WiringFactKind.SLOW_PUBLISHER)


def _slow(fact: WiringFact) -> Finding:
    deadline, period, *_ = (*fact.others, "?", "?")
    return fact_finding(
        RULE.name,
        fact,
        summary=f"{fact.value} does not hold the deadline that it offers on {fact.subject}",
        cause=f"the deadline is {deadline} s, and its timer sends every {period} s",
        remedy="send more often, or offer and request a longer deadline",
        nodes=(fact.value,),
        topics=(fact.subject,),
    )


def _by_qos(endpoints: Iterable[Endpoint]) -> dict[QoS | None, list[Endpoint]]:
    """Return endpoints by their QoS: few differ, where many publish to many."""
    found: dict[QoS | None, list[Endpoint]] = defaultdict(list)
    for end in endpoints:
        found[end.qos].append(end)
    return found


def incompatibilities(offered: QoS | None, requested: QoS | None) -> list[str]:
    """Return in words each policy in which an offer does not satisfy a request."""
    if offered is None or requested is None:
        return []
    checks = (
        (
            offered.reliability is Reliability.BEST_EFFORT
            and requested.reliability is Reliability.RELIABLE,
            "best effort is offered, reliable is requested",
        ),
        (
            offered.durability is Durability.VOLATILE
            and requested.durability is Durability.TRANSIENT_LOCAL,
            "volatile is offered, transient local is requested",
        ),
        (_is_longer(offered.deadline, requested.deadline), "the requested deadline is shorter"),
        (
            offered.liveliness is Liveliness.AUTOMATIC
            and requested.liveliness is Liveliness.MANUAL_BY_TOPIC,
            "automatic liveliness is offered, manual by topic is requested",
        ),
        (_is_longer(offered.lease, requested.lease), "the requested lease duration is shorter"),
    )
    return [why for is_broken, why in checks if is_broken]


def _is_longer(offered: int, requested: int) -> bool:
    """Return whether an offered duration (ns, 0 for ever) is longer than the requested one."""
    return requested > 0 and (offered == 0 or offered > requested)


def _finding(app: AppFacts, topic: str, mismatches: list[_Mismatch]) -> Finding:
    first = mismatches[0]
    senders, readers = (sorted({e.node for e in each}) for each in first[:2])
    deaf = sorted({end.node for each in mismatches for end in each.subscribers})
    others = sorted(set(deaf).difference(readers))
    more = f"; the same for {join_names(others)}" if others else ""
    endpoints = [end for each in mismatches for end in (*each.publishers, *each.subscribers)]
    return make_finding(
        RULE.name,
        topic,
        summary=f"{join_names(readers)} {conjugate(readers, 'get')} nothing from "
        f"{join_names(senders)} on {topic}",
        cause=f"their QoS do not fit: {'; '.join(first.why)}{more}",
        remedy="offer at least what is requested, or request less",
        consequence=app.consequence(topic, deaf),
        certainty=Certainty.CERTAIN,
        nodes=sorted({end.node for end in endpoints}),
        topics=(topic,),
        evidence=app.evidence(endpoints),
    )


RULE = FindingRule(
    name="qos_mismatch",
    title="The QoS of two ends of a topic do not fit",
    consequence="failure, or motion on a topic that commands it: certain",
    since="0.1.0",
    check=check,
)

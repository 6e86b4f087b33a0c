"""The ends of a topic have different message types.

## What it finds

A topic is published with one type and subscribed with another, so ROS does not connect the ends.
Often it is Twist and TwistStamped, which ROS 2 distributions differ in. It is only possible where
the type of another end is unknown, or comes from a model and no distribution is given
(`--env ROS_DISTRO=jazzy`), or where two packages of ROS 1 name a type alike: roscpp compares only
the MD5 sums of the definitions (ROS wiki: TCPROS), so copies of one connect.

For example, `/teleop` publishes Twist on `/cmd_vel`, `/diff_drive_controller` subscribes
TwistStamped.

## What to do

Give both ends one type by a parameter (`enable_stamped_cmd_vel`, `use_stamped_vel`), or convert
with a relay.

## When it is silent

Where only one side's type is known, and where all ends belong to one node that is not your own.
Where they belong to one of your own, it is an oddity.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import (
    Certainty,
    Consequence,
    Direction,
    Endpoint,
    Finding,
    FindingLevel,
    Resolution,
    WiringFactKind,
    unstamped_type,
)
from rtron.wording import conjugate, join_names

_TELL_DISTRIBUTION = "say which ROS it is for: --env ROS_DISTRO=humble, or give both ends one type"

_EndpointsOfType = Mapping[str, Sequence[Endpoint]]


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each topic with a type that only its one side has."""
    for topic in app.explicit_topics:
        published = app.types(topic, Direction.PUBLISH)
        subscribed = app.types(topic, Direction.SUBSCRIBE)
        lost = {type: each for type, each in subscribed.items() if type not in published}
        unheard = {type: each for type, each in published.items() if type not in subscribed}
        if _is_of_one_other(app, topic):
            continue
        if published and lost:
            yield _finding(app, topic, published, lost, Direction.SUBSCRIBE)
        elif subscribed and unheard:
            yield _finding(app, topic, unheard, subscribed, Direction.PUBLISH)


def _is_of_one_other(app: AppFacts, topic: str) -> bool:
    """Return whether all ends belong to one node whose source is not the user's."""
    endpoints = (*app.graph.publishers(topic), *app.graph.subscribers(topic))
    nodes = {end.node for end in endpoints}
    return len(nodes) == 1 and not app.facts.are_own(nodes)


def _finding(
    app: AppFacts,
    topic: str,
    published: _EndpointsOfType,
    subscribed: _EndpointsOfType,
    lost: Direction,
) -> Finding:
    """Return the finding on ends of which those of one direction have no other end."""
    senders = sorted({end.node for each in published.values() for end in each})
    readers = sorted({end.node for each in subscribed.values() for end in each})
    endpoints = [end for each in (*published.values(), *subscribed.values()) for end in each]
    sent, expected = join_names(list(published)), join_names(list(subscribed))
    depends = _depends_on_distribution(app, [*published, *subscribed], endpoints)
    is_one_node = senders == readers and len(senders) == 1
    may_be_copies = app.graph.ros == 1 and not _bare_names(published).isdisjoint(
        _bare_names(subscribed)
    )
    is_unsure = depends or may_be_copies or app.has_unknown_type(topic, lost.opposite)
    summary = f"{join_names(readers)} {conjugate(readers, 'get')} nothing from {topic}"
    if lost is Direction.PUBLISH:
        what = f"what {join_names(senders)} {conjugate(senders, 'publish')}"
        summary = f"nobody gets {what} on {topic}"
    return make_finding(
        RULE.name,
        topic,
        summary=summary,
        cause=f"{join_names(senders)} {conjugate(senders, 'publish')} {sent}, "
        f"{join_names(readers)} {conjugate(readers, 'expect')} {expected}",
        remedy=_TELL_DISTRIBUTION if depends else "give both ends one message type",
        consequence=Consequence.ODDITY if is_one_node else app.consequence(topic, readers),
        certainty=Certainty.POSSIBLE if is_unsure else Certainty.CERTAIN,
        level=FindingLevel.PEDANTIC if depends else None,
        nodes=(*senders, *readers),
        topics=(topic,),
        evidence=app.evidence(endpoints),
    )


def _bare_names(types: Iterable[str]) -> set[str]:
    return {type.rpartition("/")[2] for type in types}


def _depends_on_distribution(app: AppFacts, types: list[str], endpoints: list[Endpoint]) -> bool:
    """Return whether only a stamp parts the types, and a model chose it by a guess at the ROS."""
    is_given = any(fact.kind is WiringFactKind.DISTRIBUTION for fact in app.graph.wiring)
    is_modelled = any(end.resolution is Resolution.MODEL for end in endpoints)
    return is_modelled and not is_given and len(set(map(unstamped_type, types))) == 1


RULE = FindingRule(
    name="type_mismatch",
    title="The ends of a topic have different message types",
    consequence="failure, motion on a topic that commands it: certain; possible by distribution",
    since="0.1.0",
    check=check,
)

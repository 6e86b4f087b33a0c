"""Whether two ends of a topic connect at all: their types, and QoS offered and asked for.

Rules: ROS 2, About Quality of Service settings, QoS compatibilities.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtron.vocabulary import Durability, Liveliness, QoS, Reliability, normalise_type

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtron.wire.ros2.endpoints import Ros2Endpoint


def incompatibility(publisher: Ros2Endpoint, subscriber: Ros2Endpoint) -> str:
    """Return why a subscriber does not hear a publisher, nothing if it does."""
    published_type, subscribed_type = (
        normalise_type(publisher.type),
        normalise_type(subscriber.type),
    )
    if published_type != subscribed_type:
        return f"{published_type} is published, {subscribed_type} is asked for"
    return ", ".join(qos_incompatibilities(publisher.qos, subscriber.qos))


def qos_incompatibilities(offered: QoS, requested: QoS) -> Iterator[str]:
    """Yield each quality that is asked for and not offered."""
    if offered.reliability is not requested.reliability is Reliability.RELIABLE:
        yield "reliable is asked for, best effort is offered"
    if offered.durability is not requested.durability is Durability.TRANSIENT_LOCAL:
        yield "transient local is asked for, volatile is offered"
    if offered.liveliness is not requested.liveliness is Liveliness.MANUAL_BY_TOPIC:
        yield "liveliness by topic is asked for, automatic is offered"
    yield from _duration_incompatibility("deadline", offered.deadline, requested.deadline)
    yield from _duration_incompatibility("lease of the liveliness", offered.lease, requested.lease)


def _duration_incompatibility(what: str, offered: int, requested: int) -> Iterator[str]:
    """Yield a clash of durations (ns, 0 for ever): at most what is asked for must be offered."""
    if requested and (not offered or offered > requested):
        limit = f"{offered / 1e6:g} ms" if offered else "none"
        yield f"a {what} of {requested / 1e6:g} ms is asked for, {limit} is offered"

"""Whether two ends of a topic connect at all: their types, and QoS offered and asked for.

Rules: ROS 2, About Quality of Service settings, QoS compatibilities.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtron.vocabulary import Durability, Liveliness, QoS, Reliability, normalise_type

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtron.wire.ros2.endpoints import Ros2Endpoint


def misfit(publisher: Ros2Endpoint, subscriber: Ros2Endpoint) -> str:
    """Return why a subscriber does not hear a publisher, nothing if it does."""
    one, other = normalise_type(publisher.type), normalise_type(subscriber.type)
    if one != other:
        return f"{one} is published, {other} is asked for"
    return ", ".join(qos_clashes(publisher.qos, subscriber.qos))


def qos_clashes(offered: QoS, asked: QoS) -> Iterator[str]:
    """Yield each quality that is asked for and not offered."""
    if offered.reliability is not asked.reliability is Reliability.RELIABLE:
        yield "reliable is asked for, best effort is offered"
    if offered.durability is not asked.durability is Durability.TRANSIENT_LOCAL:
        yield "transient local is asked for, volatile is offered"
    if offered.liveliness is not asked.liveliness is Liveliness.MANUAL_BY_TOPIC:
        yield "liveliness by topic is asked for, automatic is offered"
    yield from _slower("deadline", offered.deadline, asked.deadline)
    yield from _slower("lease of the liveliness", offered.lease, asked.lease)


def _slower(what: str, offered: int, asked: int) -> Iterator[str]:
    """Yield a clash of durations (ns, 0 for ever): at most what is asked for must be offered."""
    if asked and (not offered or offered > asked):
        given = f"{offered / 1e6:g} ms" if offered else "none"
        yield f"a {what} of {asked / 1e6:g} ms is asked for, {given} is offered"

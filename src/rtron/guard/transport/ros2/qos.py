"""QoS that fits: asked for so that a publisher matches, offered so that no subscriber is lost."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy

from rtron.vocabulary import SECOND, Durability, Liveliness, QoS, Reliability

if TYPE_CHECKING:
    from collections.abc import Iterable

_READ_AHEAD = 100
"""So many messages of all publishers wait in a reader; the oldest make room."""
_MOMENT = SECOND
"""A writer keeps so long what is meant for the moment: a reader on a busy machine may need it."""


def asked_for(offered: QoS) -> QoSProfile:
    """Return what to ask a publisher for, to get all that it offers, what it has kept included.

    Nothing is asked of its deadline, lifespan or liveliness.
    """
    return profile(QoS(reliability=offered.reliability, durability=offered.durability), _READ_AHEAD)


def strongest(offered: Iterable[QoS]) -> QoS:
    """Return what matches every subscriber that one of these matches (ROS 2: QoS compatibilities).

    The shortest deadline and lease of those that have one, the longest lifespan.
    """
    found = list(offered)
    reliable = any(qos.reliability is Reliability.RELIABLE for qos in found)
    kept = any(qos.durability is Durability.TRANSIENT_LOCAL for qos in found)
    manual = any(qos.liveliness is Liveliness.MANUAL_BY_TOPIC for qos in found)
    lifespans = [qos.lifespan for qos in found]
    return QoS(
        reliability=Reliability.RELIABLE if reliable or not found else Reliability.BEST_EFFORT,
        durability=Durability.TRANSIENT_LOCAL if kept else Durability.VOLATILE,
        deadline=_least(qos.deadline for qos in found),
        lifespan=0 if 0 in lifespans else max(lifespans, default=0),
        liveliness=Liveliness.MANUAL_BY_TOPIC if manual else Liveliness.AUTOMATIC,
        lease=_least(qos.lease for qos in found),
    )


def momentary(qos: QoS) -> QoS:
    """Return what matches the same subscribers, and leaves late ones no more than the last second.

    DDS drops what is older from a writer that keeps its words (lifespan).
    """
    if qos.durability is Durability.VOLATILE:
        return qos
    return replace(qos, lifespan=min(qos.lifespan or _MOMENT, _MOMENT))


def kept(qos: QoS) -> QoS:
    """Return what matches the same subscribers, and is kept for late ones."""
    return replace(qos, durability=Durability.TRANSIENT_LOCAL)


def profile(qos: QoS, depth: int) -> QoSProfile:
    """Return a profile as rclpy takes it, which keeps the last `depth` messages."""
    best_effort = qos.reliability is Reliability.BEST_EFFORT
    kept = qos.durability is Durability.TRANSIENT_LOCAL
    manual = qos.liveliness is Liveliness.MANUAL_BY_TOPIC
    return QoSProfile(
        depth=depth,
        reliability=ReliabilityPolicy.BEST_EFFORT if best_effort else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if kept else DurabilityPolicy.VOLATILE,
        deadline=Duration(nanoseconds=qos.deadline),
        lifespan=Duration(nanoseconds=qos.lifespan),
        liveliness=LivelinessPolicy.MANUAL_BY_TOPIC if manual else LivelinessPolicy.AUTOMATIC,
        liveliness_lease_duration=Duration(nanoseconds=qos.lease),
    )


def _least(durations: Iterable[int]) -> int:
    return min((each for each in durations if each), default=0)

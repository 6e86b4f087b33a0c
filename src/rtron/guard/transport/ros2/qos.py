"""QoS to request so that a publisher matches, and to offer so that every subscriber matches."""

from __future__ import annotations

import math
from copy import copy
from dataclasses import replace
from typing import TYPE_CHECKING

from rclpy.duration import Duration
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)

from rtron.vocabulary import SECOND, Durability, Liveliness, QoS, Reliability
from rtron.vocabulary.plan import MAX_QUEUE_BYTES

if TYPE_CHECKING:
    from collections.abc import Iterable

KEEP_ALL_DEPTH = 5000
"""How many messages Fast DDS keeps of a topic of which all are kept (`max_samples`)."""
HANDOVER_S = 1.0
"""How long a reader or writer stays beside the one that takes its place."""
_COMMAND_LIFESPAN = SECOND
"""How long a writer keeps commands: a reader on a busy machine may need them (ns)."""

_MIN_PERIOD = SECOND // 1000
"""The shortest deadline or lease that is offered: for one of 1 ns Cyclone DDS does nothing else."""


def requested_profile(offered: QoS, queue_size: int, *, keep_all: bool = False) -> QoSProfile:
    """Return the profile that gets all messages of a publisher, transient-local ones included.

    It requests nothing of the publisher's deadline, lifespan or liveliness. Discovery does not tell
    whether a publisher keeps all: `keep_all` loses nothing of one that does, nor of others.
    """
    requested = QoS(reliability=offered.reliability, durability=offered.durability)
    is_reliable = offered.reliability is Reliability.RELIABLE
    return profile(requested, queue_size, keep_all=keep_all and is_reliable)


def most_size(depth: int) -> float:
    """Return how many bytes a message may have in a reader or writer in which `depth` wait."""
    return MAX_QUEUE_BYTES // depth if depth > 1 else math.inf


def fitting_depth(size: int) -> int:
    """Return how many messages may wait where these have turned out to have `size` bytes.

    They get half of the room, so that sizes that grow change it only now and then.
    """
    return max(1, MAX_QUEUE_BYTES // (2 * size))


def strongest(profiles: Iterable[QoS]) -> QoS:
    """Return QoS that matches every subscriber that one of these matches (ROS 2, compatibility).

    The shortest deadline and lease of those that have one, but no less than 1 ms; the longest
    lifespan.
    """
    profiles_list = list(profiles)
    reliable = any(qos.reliability is Reliability.RELIABLE for qos in profiles_list)
    is_transient_local = any(qos.durability is Durability.TRANSIENT_LOCAL for qos in profiles_list)
    manual = any(qos.liveliness is Liveliness.MANUAL_BY_TOPIC for qos in profiles_list)
    lifespans = [qos.lifespan for qos in profiles_list]
    return QoS(
        reliability=Reliability.RELIABLE
        if reliable or not profiles_list
        else Reliability.BEST_EFFORT,
        durability=Durability.TRANSIENT_LOCAL if is_transient_local else Durability.VOLATILE,
        deadline=_minimum(qos.deadline for qos in profiles_list),
        lifespan=0 if 0 in lifespans else max(lifespans, default=0),
        liveliness=Liveliness.MANUAL_BY_TOPIC if manual else Liveliness.AUTOMATIC,
        lease=_minimum(qos.lease for qos in profiles_list),
    )


def command_qos(qos: QoS) -> QoS:
    """Return QoS that matches the same subscribers, but gives late ones only the last second.

    The lifespan makes DDS drop what is older.
    """
    if qos.durability is Durability.VOLATILE:
        return qos
    return replace(qos, lifespan=min(qos.lifespan or _COMMAND_LIFESPAN, _COMMAND_LIFESPAN))


def latched(qos: QoS) -> QoS:
    """Return QoS that matches the same subscribers, and keeps messages for late ones."""
    return replace(qos, durability=Durability.TRANSIENT_LOCAL)


def profile(qos: QoS, depth: int, *, keep_all: bool = False) -> QoSProfile:
    """Return a profile as rclpy takes it, which keeps the last `depth` messages, or all."""
    best_effort = qos.reliability is Reliability.BEST_EFFORT
    is_transient_local = qos.durability is Durability.TRANSIENT_LOCAL
    manual = qos.liveliness is Liveliness.MANUAL_BY_TOPIC
    return QoSProfile(
        history=HistoryPolicy.KEEP_ALL if keep_all else HistoryPolicy.KEEP_LAST,
        depth=depth,
        reliability=ReliabilityPolicy.BEST_EFFORT if best_effort else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL
        if is_transient_local
        else DurabilityPolicy.VOLATILE,
        deadline=Duration(nanoseconds=qos.deadline),
        lifespan=Duration(nanoseconds=qos.lifespan),
        liveliness=LivelinessPolicy.MANUAL_BY_TOPIC if manual else LivelinessPolicy.AUTOMATIC,
        liveliness_lease_duration=Duration(nanoseconds=qos.lease),
    )


def with_depth(former: QoSProfile, depth: int) -> QoSProfile:
    """Return a profile that differs in what it keeps: the last `depth` messages."""
    changed = copy(former)
    changed.history, changed.depth = HistoryPolicy.KEEP_LAST, depth
    return changed


def _minimum(durations: Iterable[int]) -> int:
    return max(_MIN_PERIOD, min(finite)) if (finite := [each for each in durations if each]) else 0

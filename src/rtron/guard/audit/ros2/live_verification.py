"""Looking at a ROS 2 domain once, from outside: as a participant that speaks to nobody."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from rtron.errors import SourceError
from rtron.guard.audit.ros2.expected_graph import ExpectedGraph
from rtron.guard.audit.ros2.observed_graph import ROSOUT_TOPIC, GraphReader
from rtron.guard.audit.ros2.verification import verify_ros2
from rtron.wire.ros2.discovery_tuning import configure_cyclone, enable_fast_announcements

if TYPE_CHECKING:
    from rtron.guard.audit.ros2.observed_graph import ObservedGraph
    from rtron.vocabulary import Plan
    from rtron.vocabulary.verification import Verification

_NODE = "/rtron_verify"
_POLL_S = 0.1
_QUIET_S = 3.5
"""Longer than the 3 s after which Fast DDS repeats an announcement."""
_MIN_WAIT_S = 15.0
_HELP = "is the app running? see ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE, RMW_IMPLEMENTATION"
_HELP_RCLPY = "pip install rtron[ros2], or source your ROS"


def verify_domain(plan: Plan, timeout: float, domain: int | None = None) -> Verification:
    """Audit the app that runs in a domain (None: the environment's), once its graph has settled.

    That is when nothing has changed for 3.5 s, within `timeout` seconds and at least 15.
    SourceError if there is no rclpy, nobody in the domain, or no end of changes: what was missed
    could be what is wrong.
    """
    try:
        from rtron.guard.transport.ros2.abi_check import check_endpoint_info  # noqa: PLC0415
        from rtron.wire.ros2.session import Ros2Session  # noqa: PLC0415 - only where ROS 2 is chosen
    except ImportError as error:
        raise SourceError("ROS 2 is not there: no rclpy", help=_HELP_RCLPY) from error
    enable_fast_announcements()
    configure_cyclone()
    session = Ros2Session(domain)
    try:
        check_endpoint_info(session.node(_NODE))
        topics = (*ExpectedGraph(plan).topics, ROSOUT_TOPIC)
        observed = _wait_until_settled(
            GraphReader(session.node(_NODE)), topics, max(timeout, _MIN_WAIT_S)
        )
    finally:
        session.close()
    return verify_ros2(plan, observed)


def _wait_until_settled(
    reader: GraphReader, topics: tuple[str, ...], limit: float
) -> ObservedGraph:
    started = changed = time.monotonic()
    last_state: object = None
    while (now := time.monotonic()) - started < limit and now - changed < _QUIET_S:
        state = (tuple(reader.endpoints(topics)), reader.nodes())
        if state != last_state or not set(state[1]) - {_NODE}:
            last_state, changed = state, now
        time.sleep(_POLL_S)
    observed = reader.snapshot(topics)
    if not set(observed.nodes) - {_NODE}:
        raise SourceError("nothing can be verified: nobody is in the ROS 2 domain", help=_HELP)
    if now - changed < _QUIET_S:
        message = f"nothing can be verified: the graph still changes after {limit:g} s"
        raise SourceError(
            message, help="wait until the app has started, or give a longer --timeout"
        )
    return observed

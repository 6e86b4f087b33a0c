"""Looking at a ROS 2 domain once, from outside: as a participant that speaks to nobody."""

from __future__ import annotations

import os
import time
from contextlib import closing
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from rtron.errors import SourceError
from rtron.guard.audit.ros2.expected_graph import ExpectedGraph
from rtron.guard.audit.ros2.observed_graph import ROSOUT_TOPIC, GraphReader
from rtron.guard.audit.ros2.verification import verify_ros2, verify_ros2_cell
from rtron.guard.cell.cell_report import verify_cells
from rtron.vocabulary import VERIFY_NODE
from rtron.wire.ros2.discovery_tuning import configure_cyclone, configure_fast_dds
from rtron.wire.ros2.domain_id import domain_address, domain_id
from rtron.wire.ros2.service_names import is_service_topic

if TYPE_CHECKING:
    from rtron.guard.audit.ros2.celled_graph import CellReader
    from rtron.guard.audit.ros2.observed_graph import ObservedGraph
    from rtron.guard.cell.access import CellAccess
    from rtron.vocabulary import Plan
    from rtron.vocabulary.verification import Verification

_POLL_S = 0.1
_QUIET_S = 3.5
"""Longer than the 3 s after which Fast DDS repeats an announcement."""
_MIN_WAIT_S = 15.0
_HELP = "is the app running? see ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE, RMW_IMPLEMENTATION"
_HELP_RCLPY = "pip install rtron[ros2], or source your ROS"


def verify_domain(plan: Plan, timeout: float, domain: int | None = None) -> Verification:
    """Audit the app that runs in a domain (None: the environment's), once its graph has settled.

    That is when nothing has changed for 3.5 s, within `timeout` seconds and at least 15. The same
    is done in each cell. SourceError if there is no rclpy, nobody in the domain, or no end of
    changes: what was missed could be what is wrong.
    """
    limit = max(timeout, _MIN_WAIT_S)
    outside = verify_ros2(plan, _observe(plan, limit, domain))
    look = partial(_look_inside, plan, limit, domain_id(domain))
    return verify_cells(plan, domain_address(domain), outside, look)


def _observe(plan: Plan, limit: float, domain: int | None) -> ObservedGraph:
    """Return what is in a domain, as a participant there."""
    try:
        from rtron.guard.transport.ros2.abi_check import check_endpoint_info  # noqa: PLC0415
        from rtron.wire.ros2.session import Ros2Session, rmw_identifier  # noqa: PLC0415
    except ImportError as error:
        raise SourceError("ROS 2 is not there: no rclpy", help=_HELP_RCLPY) from error
    configure_fast_dds(rmw_identifier(), shares_memory=False)
    configure_cyclone()
    with closing(Ros2Session(domain, VERIFY_NODE)) as session:
        check_endpoint_info(session.node(VERIFY_NODE))
        return _wait_until_settled(GraphReader(session.node(VERIFY_NODE)), _topics(plan), limit)


def _look_inside(plan: Plan, limit: float, domain: int, access: CellAccess) -> Verification:
    """Compare the plan with what is in a cell, and try as root whether shared memory leads there.

    An ordinary user can make no network of its own to try from.
    """
    from rtron.guard.audit.ros2.celled_graph import (  # noqa: PLC0415 - it needs rclpy
        CellReader,
        find_by_shared_memory,
    )

    topics = tuple(topic for topic in _topics(plan) if not is_service_topic(topic))
    with closing(CellReader(access)) as reader:
        inside = _wait_until_settled(reader, topics, limit)
    found = verify_ros2_cell(plan, inside)
    if os.getuid():
        return found
    reached = find_by_shared_memory(domain, inside)
    where = f"in the cell of {access.node}"
    problems = tuple(f"{each} {where} is reached by shared memory" for each in reached)
    proven = (f"by shared memory, nobody {where} is reached from another network",)
    return replace(found, problems=problems, proven=() if reached else proven)


def _topics(plan: Plan) -> tuple[str, ...]:
    return (*ExpectedGraph(plan).topics, ROSOUT_TOPIC)


def _wait_until_settled(
    reader: GraphReader | CellReader, topics: tuple[str, ...], limit: float
) -> ObservedGraph:
    started = changed = time.monotonic()
    last_state: object = None
    while (now := time.monotonic()) - started < limit and now - changed < _QUIET_S:
        state = (tuple(reader.endpoints(topics)), reader.nodes())
        if state != last_state or not set(state[1]) - {VERIFY_NODE}:
            last_state, changed = state, now
        time.sleep(_POLL_S)
    observed = reader.snapshot(topics)
    if not set(observed.nodes) - {VERIFY_NODE}:
        raise SourceError("nothing can be verified: nobody is in the ROS 2 domain", help=_HELP)
    if now - changed < _QUIET_S:
        message = f"nothing can be verified: the graph still changes after {limit:g} s"
        raise SourceError(
            message, help="wait until the app has started, or give a longer --timeout"
        )
    return observed

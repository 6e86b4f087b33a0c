"""The ends of a guarded action of ROS 2: its server's private name, each flow's, and the public."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from rtron.guard.transport.common.protocol import TypeInfo
from rtron.guard.transport.ros2.action_client import Back
from rtron.guard.transport.ros2.action_server import Around, Front
from rtron.guard.transport.ros2.service_calls import Requests
from rtron.vocabulary import SECOND, UNAPPROVED, ActionEnd, Stream, flow_topic, output_topic
from rtron.wire.ros2.interfaces import interface

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rclpy.node import Node

    from rtron.guard.action.ros2.endpoints import (
        AnswerCancel,
        AnswerGoal,
        AnswerResult,
        GoalMessage,
        Hears,
    )
    from rtron.guard.transport.ros2.context import Surroundings

log = logging.getLogger(__name__)

_OFFERED_FOR = 5 * SECOND
"""So long the action is offered although its server is away: a client waits for one that is not."""


class ActionEnds:
    """Towards the clients the action is offered once its server is there, and while it is.

    SourceError if the type is not installed.
    """

    def __init__(self, stream: Stream, node: Node, hears: Hears, shared: Surroundings) -> None:
        found = interface(stream.type)
        self.info = TypeInfo(found.name, found.md5sum, found.definition)
        around = Around(node, found.cls, self.info, shared, Requests())
        self._hears = hears
        self._loop = shared.loop
        self._back = Back(output_topic(stream.action), stream.successors, self, around)
        flows = [(flow_topic(stream.action, f.name), f.name, f.publisher) for f in stream.flows]
        names = [*flows, (stream.action, UNAPPROVED, "*")]
        self._fronts = {
            flow: Front(name, flow, publisher, hears, around) for name, flow, publisher in names
        }
        self._left = 0
        self._is_there = False

    def open(self) -> None:
        """Join the graph."""
        self._back.open()

    def close(self) -> None:
        """Leave the graph."""
        self._back.close()
        for front in self._fronts.values():
            front.leave()

    def send_goal(self, goal: GoalMessage, answered: AnswerGoal) -> None:
        """Send a goal to the server."""
        self._back.send_goal(goal, answered)

    def cancel(self, id: bytes, stamp: int, answered: AnswerCancel) -> None:
        """Send a cancel to the server."""
        self._back.cancel(id, stamp, answered)

    def get_result(self, id: bytes, answered: Callable[[int, object], None]) -> None:
        """Ask the server for a result."""
        self._back.get_result(id, answered)

    def tell(self, end: ActionEnd, message: bytes, flows: Sequence[str] | None = None) -> None:
        """Tell the clients of some flows, or all, and whoever listens under the public name."""
        chosen = self._fronts if flows is None else dict.fromkeys((*flows, UNAPPROVED))
        for flow in chosen:
            if flow in self._fronts:
                self._fronts[flow].tell(end, message)

    def place(self, token: str) -> AnswerResult | None:
        """Return the place of a request that came to the guard before."""
        flow, _, place = token.partition(" ")
        front = self._fronts.get(flow)
        return front.place(place) if front else None

    def server_came(self, node: str, incarnation: bytes) -> None:
        """Offer the action, and tell."""
        log.info("the server %s is there", node)
        self._is_there = True
        for front in self._fronts.values():
            front.open()
        self._hears.server_came(node, incarnation)

    def server_told(self, end: ActionEnd, message: bytes) -> None:
        """Tell what the server says."""
        self._hears.server_told(end, message)

    def server_doubted(self, why: str) -> None:
        """Tell."""
        self._hears.server_doubted(why)

    def server_left(self) -> None:
        """Tell, and offer the action no more after a while."""
        self._is_there, self._left = False, self._left + 1
        left = self._left

        def close() -> None:
            if not self._is_there and left == self._left:
                for front in self._fronts.values():
                    front.close()

        self._hears.server_left()
        self._loop.call_at(self._loop.now() + _OFFERED_FOR, close)

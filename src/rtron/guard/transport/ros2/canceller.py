"""Asking the server of an action that has no guard to cancel goals."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from action_msgs.srv import CancelGoal
from rclpy.qos import qos_profile_services_default

from rtron.errors import WireError
from rtron.guard.transport.ros2.action_server import goal_info
from rtron.guard.transport.ros2.service_calls import ServiceCalls
from rtron.vocabulary import Ros2ActionEntity, ros2_entity_name

if TYPE_CHECKING:
    from rclpy.node import Node

log = logging.getLogger(__name__)


class GoalCanceller:
    """A client of an action's cancels under its public name; answers are not waited for."""

    def __init__(self, node: Node, action: str) -> None:
        self._action = action
        self._requests = ServiceCalls()
        name = ros2_entity_name(action, Ros2ActionEntity.CANCEL_GOAL)
        self._client = node.create_client(
            CancelGoal, name, qos_profile=qos_profile_services_default
        )

    def __call__(self, id: bytes) -> None:
        """Ask for the cancel of the goal with this id."""
        try:
            request = CancelGoal.Request(goal_info=goal_info(id, 0))
            self._requests.send_request(self._client.handle, request)
        except WireError as error:
            log.warning("%s: %s", self._action, error)

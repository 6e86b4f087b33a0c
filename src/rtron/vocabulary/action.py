"""An action as one unit: actionlib's five topics, or ROS 2's three services and two topics.

Of an action of ROS 1 the goals are a topic, `<action>/goal` (ROS wiki: actionlib). In ROS 2 they
are requests, so there the action's own name stands for them (design.ros2.org: actions).
"""

import re

from rtron.vocabulary.enums import Word
from rtron.vocabulary.names import normalise_type

_ACTION_TYPE = re.compile(r"[A-Za-z]\w*/action/[A-Za-z][A-Za-z0-9]*", re.ASCII)


class ActionPart(Word):
    """The topics of an action of ROS 1: clients publish the first two, the server the others."""

    GOAL = "goal"
    CANCEL = "cancel"
    STATUS = "status"
    FEEDBACK = "feedback"
    RESULT = "result"


class ActionEnd(Word):
    """What an action of ROS 2 is made of: three services of the server, and two topics."""

    SEND_GOAL = "send_goal"
    CANCEL_GOAL = "cancel_goal"
    GET_RESULT = "get_result"
    FEEDBACK = "feedback"
    STATUS = "status"


ASKED = (ActionPart.GOAL, ActionPart.CANCEL)
ANSWERED = (ActionPart.STATUS, ActionPart.FEEDBACK, ActionPart.RESULT)
REQUESTED = (ActionEnd.SEND_GOAL, ActionEnd.CANCEL_GOAL, ActionEnd.GET_RESULT)
TOLD = (ActionEnd.FEEDBACK, ActionEnd.STATUS)
SERVER = "server"
"""The flow of an action's server on the three topics that it publishes."""


def action_of(topic: str, type: str) -> str:
    """Return the action whose goals a topic carries, or nothing; in ROS 2 it is the topic."""
    if is_action_type(type):
        return topic
    goals = normalise_type(type).endswith("ActionGoal") and topic.endswith("/goal")
    return topic.removesuffix("/goal") if goals else ""


def is_action_type(type: str) -> bool:
    """Tell whether a type is that of an action of ROS 2, like `nav2_msgs/action/Spin`."""
    return _ACTION_TYPE.fullmatch(type) is not None


def part_topic(action: str, part: ActionPart) -> str:
    """Return the public name of one of an action's topics in ROS 1."""
    return f"{action}/{part}"


def end_name(action: str, end: ActionEnd) -> str:
    """Return the name of one of an action's services and topics in ROS 2."""
    return f"{action}/_action/{end}"

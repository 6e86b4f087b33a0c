"""An action of ROS 1: actionlib's five topics, which move as one unit (ROS wiki: actionlib)."""

from rtron.vocabulary.enums import Word
from rtron.vocabulary.names import normalise_type


class ActionPart(Word):
    """The topics of an action: clients publish the first two, the server the others."""

    GOAL = "goal"
    CANCEL = "cancel"
    STATUS = "status"
    FEEDBACK = "feedback"
    RESULT = "result"


ASKED = (ActionPart.GOAL, ActionPart.CANCEL)
ANSWERED = (ActionPart.STATUS, ActionPart.FEEDBACK, ActionPart.RESULT)
SERVER = "server"
"""The flow of an action's server on the three topics that it publishes."""


def action_of(topic: str, type: str) -> str:
    """Return the action whose goals a topic carries, or nothing."""
    goals = normalise_type(type).endswith("ActionGoal") and topic.endswith("/goal")
    return topic.removesuffix("/goal") if goals else ""


def part_topic(action: str, part: ActionPart) -> str:
    """Return the public name of one of an action's topics."""
    return f"{action}/{part}"

"""Actions in a bag, which has only those of the five topics that something was sent on."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from rtron.sources.live.ros1.actions import PARTS, actions_among
from rtron.vocabulary import Action, Direction, Endpoint

_GOAL, _STATUS, _RESULT = "goal", "status", "result"
_GOAL_TYPE = "ActionGoal"
_STATUS_TYPE = "actionlib_msgs/GoalStatusArray"


def actions_in_bag(endpoints: Sequence[Endpoint]) -> tuple[Action, ...]:
    """Return the actions among the endpoints.

    A recorded action often lacks the topics `cancel`, `feedback` or `result`, because nobody sent
    anything there. What is left shows its goal or its status by type; whoever publishes the status
    is the server (actionlib: DetailedDescription).
    """
    return tuple(dict.fromkeys(actions_among([*endpoints, *_silent(endpoints)])))


def _silent(endpoints: Sequence[Endpoint]) -> Iterator[Endpoint]:
    """Yield ends for the missing topics of what is an action by the type of its goal or status."""
    recorded = {each.topic for each in endpoints}
    for each in endpoints:
        space, _, part = each.topic.rpartition("/")
        tells_status = part == _STATUS and each.type == _STATUS_TYPE
        if tells_status:
            yield replace(each, topic=f"{space}/{_RESULT}", type="")
        if tells_status or (part == _GOAL and each.type.endswith(_GOAL_TYPE)):
            missing = {f"{space}/{other}" for other in PARTS} - recorded
            for topic in sorted(missing):
                yield replace(each, topic=topic, type="", direction=Direction.SUBSCRIBE)

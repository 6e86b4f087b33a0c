"""Actions in a bag, which has only those of the five topics that something was sent on."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from rtron.sources.live.ros1.actions import ACTION_TOPICS, find_actions
from rtron.vocabulary import Action, Direction, Endpoint

_GOAL, _STATUS, _RESULT = "goal", "status", "result"
_GOAL_TYPE = "ActionGoal"
_STATUS_TYPE = "actionlib_msgs/GoalStatusArray"


def find_recorded_actions(endpoints: Sequence[Endpoint]) -> tuple[Action, ...]:
    """Return the actions among the endpoints.

    A recorded action often lacks the topics `cancel`, `feedback` or `result`, because nobody sent
    anything there. What is left shows its goal or its status by type; whoever publishes the status
    is the server (actionlib: DetailedDescription).
    """
    return tuple(dict.fromkeys(find_actions([*endpoints, *_unrecorded_topics(endpoints)])))


def _unrecorded_topics(endpoints: Sequence[Endpoint]) -> Iterator[Endpoint]:
    """Yield ends for the missing topics of what is an action by the type of its goal or status."""
    recorded = {each.topic for each in endpoints}
    for each in endpoints:
        namespace, _, part = each.topic.rpartition("/")
        is_status = part == _STATUS and each.type == _STATUS_TYPE
        if is_status:
            yield replace(each, topic=f"{namespace}/{_RESULT}", type="")
        if is_status or (part == _GOAL and each.type.endswith(_GOAL_TYPE)):
            missing = {f"{namespace}/{other}" for other in ACTION_TOPICS} - recorded
            for topic in sorted(missing):
                yield replace(each, topic=topic, type="", direction=Direction.SUBSCRIBE)

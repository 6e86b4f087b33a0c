"""A thousand goals of three clients in random order, while a stranger floods."""

import pytest
from action_load import COUNT, FLOOD, Load

from rtron.vocabulary import SECOND, PolicyName

pytestmark = pytest.mark.ros1
PATIENT = 60 * SECOND


@pytest.mark.parametrize(
    ("policy", "server", "max_age"),
    [
        (PolicyName.FIFO_QUEUE, "cpp", PATIENT),
        (PolicyName.FIFO_QUEUE, "py", SECOND),
        (PolicyName.PRIORITY_QUEUE, "cpp", SECOND),
    ],
    ids=["FIFO_Queue-all", "FIFO_Queue", "Priority_Queue"],
)
def test_each_goal_is_answered_once_and_none_is_late(ros1, programs, policy, server, max_age):
    load = Load(ros1, programs, policy, server=server, max_age=max_age)
    load.run()
    ends = load.ends()
    assert len(ends) == COUNT
    expected = {"SUCCEEDED"} if max_age == PATIENT else {"SUCCEEDED", "RECALLED"}
    assert set(ends.values()) == expected
    assert load.flooded() > FLOOD
    assert not load.answered_otherwise()
    assert not load.touched()
    assert not load.late()

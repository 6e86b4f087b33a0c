"""Goals of three clients in random order, while a stranger floods."""

import pytest
from action_load import FLOOD, Load

from rtron.vocabulary import SECOND, PolicyName

pytestmark = pytest.mark.ros1
PATIENT = 60 * SECOND


@pytest.mark.long
@pytest.mark.parametrize(
    ("policy", "server", "max_age"),
    [
        (PolicyName.FIFO_QUEUE, "cpp", PATIENT),
        (PolicyName.FIFO_QUEUE, "py", SECOND),
        (PolicyName.PRIORITY_QUEUE, "cpp", SECOND),
    ],
    ids=["FIFO_Queue-all", "FIFO_Queue", "Priority_Queue"],
)
def test_each_of_a_thousand_goals_is_answered_once(ros1, programs, policy, server, max_age):
    load = run(ros1, programs, policy, server=server, max_age=max_age)
    expected = {"SUCCEEDED"} if max_age == PATIENT else {"SUCCEEDED", "RECALLED"}
    assert set(load.ends().values()) == expected
    assert load.flooded() > FLOOD


@pytest.mark.long
@pytest.mark.parametrize(
    ("policy", "server"), [(PolicyName.FIFO_QUEUE, "py"), (PolicyName.PRIORITY_QUEUE, "cpp")]
)
def test_each_of_a_few_goals_is_answered_once(ros1, programs, policy, server):
    load = run(ros1, programs, policy, server=server, max_age=PATIENT, count=60)
    assert set(load.ends().values()) == {"SUCCEEDED"}
    assert load.flooded() > FLOOD / 10


def run(ros1, programs, policy, *, count=1000, **settings):
    """Run a load; each goal must be answered once, by nobody else, and none may be late."""
    load = Load(ros1, programs, policy, count=count, **settings)
    load.run()
    assert len(load.ends()) == count
    assert not load.answered_otherwise()
    assert not load.touched()
    assert not load.late()
    return load

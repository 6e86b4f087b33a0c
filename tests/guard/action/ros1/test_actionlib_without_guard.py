"""The programs of these tests, without a guard: what actionlib does by itself."""

import pytest
from action_app import FOREIGN, Act, assert_served
from harness import wait_for

pytestmark = pytest.mark.ros1


@pytest.fixture
def act(ros1, programs):
    return Act(ros1, programs)


@pytest.mark.parametrize("language", ["py", pytest.param("cpp", marks=pytest.mark.long)])
def test_goals_feedback_results_and_cancels(act, language):
    clients = act.clients()
    assert_served(act.server(language), clients)


def test_two_clients_of_a_simple_server_preempt_each_other(act):
    served = act.server()
    one, other = act.client(name="/one"), act.client("cpp", name="/other")
    one.wait_for("connected")
    other.wait_for("connected")
    one.send(60_000)
    served.wait_for("started")
    other.send(1)
    assert one.done(1) == {1: "PREEMPTED"}
    assert other.done(1) == {1: "SUCCEEDED"}


def test_a_stranger_s_flood_reaches_the_server_and_cancels_goals_of_others(act):
    served = act.server()
    client = act.client(kind="simple")
    client.wait_for("connected")
    client.send(60_000)
    served.wait_for("started")
    act.flood()
    assert client.done(1)[1] in {"PREEMPTED", "RECALLED"}
    wait_for(lambda: served.executed(FOREIGN), what="a goal of the stranger")

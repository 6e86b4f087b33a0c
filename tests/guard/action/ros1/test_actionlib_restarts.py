"""Clients, servers and the guard that end midway: each goal is answered, none runs twice."""

import pytest
from action_app import ACT, GUARD, SERVER, Act, action_plan
from harness import wait_for

from rtron.vocabulary import PolicyName

pytestmark = pytest.mark.ros1
TWO = ("/one", "/other")
LONG = 60_000
RESULTS = f"/rtron{ACT}/result/out"


@pytest.fixture
def busy(ros1, programs):
    """Return an action whose server works on /one's goal, while two of /other's wait."""
    act = Act(ros1, programs, action_plan(PolicyName.FIFO_QUEUE, TWO))
    served = act.server()
    one, other = act.client(name="/one"), act.client("cpp", name="/other", flow="flow2")
    one.wait_for("connected")
    other.wait_for("connected")
    one.send(LONG)
    one.wait_for_state(1, "ACTIVE")
    other.send(1, 2)
    other.wait_for_state(2, "PENDING")
    return act, served, one, other


def assert_answered_once(served, *clients):
    """Assert that all goals sent are answered, once, and that none was executed twice."""
    for client in clients:
        sent = len(client.of("sent"))
        assert sorted(client.done(sent)) == list(range(1, sent + 1))
        assert len(client.of("done")) == sent
        assert set(client.results().values()) <= {1}
    assert set(served.executed().values()) == {1}


@pytest.mark.long
def test_a_server_that_dies_aborts_what_it_worked_on(busy):
    act, served, one, other = busy
    served.process.kill()
    assert one.done(1) == {1: "ABORTED"}
    assert one.text(1)
    act.server("cpp")
    other.done(2)
    act.wait_for_ends((one, "flow1"), (other, "flow2"))
    one.send(3)
    other.send(3)
    assert one.done(2)[2] == "SUCCEEDED"
    assert other.done(3)[3] == "SUCCEEDED"
    assert_answered_once(served, one, other)


@pytest.mark.long
def test_a_client_that_dies_leaves_the_goals_of_others_alone(busy):
    act, served, one, other = busy
    other.process.kill()
    wait_for(lambda: not act.ros1.connected(GUARD, "/other", RESULTS), what="the client's end")
    again = act.client("cpp", name="/other", flow="flow2")
    again.wait_for("connected")
    again.send(5, 6)
    again.wait_for_state(2, "PENDING")
    again.tell("cancel_all")
    assert set(again.done(2).values()) == {"RECALLED"}
    one.goes_on()
    one.tell("cancel 1")
    one.send(4)
    assert one.done(2) == {1: "PREEMPTED", 2: "SUCCEEDED"}
    assert_answered_once(served, one, again)


@pytest.mark.long
def test_a_client_that_dies_while_its_goal_is_in_progress_does_not_hold_up_the_others(busy):
    act, served, one, other = busy
    one.process.kill()
    again = act.client("cpp", name="/one")
    again.wait_for("connected")
    again.tell("cancel_all")
    assert other.done(2) == {1: "SUCCEEDED", 2: "SUCCEEDED"}
    assert_answered_once(served, again, other)


def test_a_guard_that_is_restarted_knows_whose_goals_there_are(busy):
    act, served, one, other = busy
    act.kill_guard()
    act.wait_for_ends((one, "flow1"), (other, "flow2"))
    other.tell("cancel_all")
    other.done(2)
    one.goes_on()
    assert not served.of("cancelled")
    one.tell("cancel 1")
    assert one.done(1) == {1: "PREEMPTED"}
    other.send(3)
    assert other.done(3)[3] == "SUCCEEDED"
    assert_answered_once(served, one, other)


@pytest.mark.long
def test_a_goal_that_ends_while_there_is_no_guard_is_answered_all_the_same(ros1, programs):
    act = Act(ros1, programs, action_plan(PolicyName.FIFO_QUEUE, TWO))
    served = act.server()
    one = act.client(name="/one")
    one.wait_for("connected")
    one.send(1500)
    one.wait_for_state(1, "ACTIVE")
    with act.without_guard():
        served.wait_for("done")
    act.wait_for_ends((one, "flow1"))
    one.done(1)
    one.send(1)
    assert one.done(2)[2] == "SUCCEEDED"
    assert_answered_once(served, one)


@pytest.mark.long
def test_all_three_restart_again_and_again_among_many_goals(ros1, programs):
    act = Act(ros1, programs, action_plan(PolicyName.PRIORITY_QUEUE, TWO))
    served = act.server()
    one, other = act.client(name="/one"), act.client("cpp", name="/other", flow="flow2")
    clients = ((one, "flow1"), (other, "flow2"))
    for client, _ in clients:
        client.wait_for("connected")
    sent = 0
    for restart in (act.kill_guard, lambda: restart_server(act, served)) * 2:
        for client, _ in clients:
            client.send(*[20] * 8)
            client.wait_for("state", 1)
        sent += 8
        for client, _ in clients:
            wait_for(lambda: acknowledged(client) >= sent, what="all are known")  # noqa: B023
        restart()
        act.wait_for_ends(*clients)
    one.done(sent)
    other.done(sent)
    assert_answered_once(served, one, other)


def acknowledged(client):
    return len({number for number, _ in client.of("state")})


def restart_server(act, served):
    served.process.kill()
    wait_for(lambda: not act.ros1.connected(GUARD, SERVER, f"/rtron{ACT}/goal/out"), what="its end")
    served.process = act.server("cpp").process

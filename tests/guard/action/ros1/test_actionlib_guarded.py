"""An action behind the guard: to clients and servers of actionlib it looks as it always did."""

from dataclasses import replace
from functools import partial

import pytest
from action_app import ACT, ANSWERED, ASKED, GUARD, SERVER, Act, action_plan, assert_served
from harness import wait_for

from rtron.vocabulary import SECOND, PolicyName

pytestmark = pytest.mark.ros1
TWO = ("/one", "/other")
LONG = 60_000


def guarded(ros1, programs, policy=PolicyName.FIFO_QUEUE, publishers=TWO, **settings):
    return Act(ros1, programs, action_plan(policy, publishers, **settings))


@pytest.fixture
def two(ros1, programs):
    """Return a guarded action, its server and two clients that are connected."""
    return connect(guarded(ros1, programs))


def connect(act):
    served = act.server()
    one, other = act.client(name="/one"), act.client("cpp", name="/other", flow="flow2")
    one.wait_for("connected")
    other.wait_for("connected")
    return act, served, one, other


@pytest.mark.parametrize("language", ["py", pytest.param("cpp", marks=pytest.mark.long)])
def test_goals_feedback_results_and_cancels(ros1, programs, language):
    publishers = [f"/client{n}" for n in range(1, 5)]
    act = guarded(ros1, programs, publishers=publishers)
    clients = act.clients()
    assert_served(act.server(language), clients)


@pytest.mark.long
def test_clients_wait_until_there_is_a_server(ros1, programs):
    act = guarded(ros1, programs)
    early = [act.client(name="/one"), act.client("cpp", name="/other", flow="flow2")]
    assert_nobody_connects(act, early)
    served = act.server()
    for client in early:
        (connected,) = client.wait_for("connected")
        assert connected.time > served.all("starting")[0].time
    for client in early:
        client.process.kill()
    kill_server(act, served)
    late = [act.client(name="/one"), act.client("cpp", name="/other", flow="flow2")]
    assert_nobody_connects(act, late)
    act.server()
    for client in late:
        client.wait_for("connected")


def assert_nobody_connects(act, clients):
    """Assert that clients find no server although all they need to ask it is there."""
    for n, client in enumerate(clients, 1):
        for part in ASKED:
            topic = f"/rtron{ACT}/{part}/flow{n}"
            asks = partial(act.ros1.connected, client.name, GUARD, topic)
            wait_for(asks, what=topic)
    act.ros1.run("rostopic", "echo", "-n", "1", "/diagnostics")
    assert not any(client.of("connected") for client in clients)


def kill_server(act, served):
    served.process.kill()
    wait_for(lambda: not act.ros1.connected(GUARD, SERVER, f"/rtron{ACT}/goal/out"), what="its end")


def test_the_guard_is_one_node_to_clients_and_to_the_public(two):
    act, *_ = two
    for part in ANSWERED:
        assert act.ros1.publishers(f"/rtron{ACT}/{part}/out") == {GUARD}
        assert act.ros1.publishers(f"{ACT}/{part}") == {GUARD}
    for part in ASKED:
        assert act.ros1.publishers(f"/rtron{ACT}/{part}/out") == {GUARD}
        assert act.ros1.subscribers(f"/rtron{ACT}/{part}/flow1") == {GUARD}


def test_goals_wait_for_their_turn_and_are_pending_meanwhile(two):
    _, served, one, other = two
    one.send(2000)
    served.wait_for("started")
    other.send(1)
    other.wait_for_state(1, "PENDING")
    one.send(2)
    one.wait_for_state(2, "PENDING")
    assert one.done(2) == {1: "SUCCEEDED", 2: "SUCCEEDED"}
    assert other.done(1) == {1: "SUCCEEDED"}
    assert [words[1] for words in served.of("started")] == ["2000", "1", "2"]


def test_under_priority_queue_the_highest_waiting_goal_is_next(ros1, programs):
    _, served, one, other = connect(guarded(ros1, programs, PolicyName.PRIORITY_QUEUE))
    other.send(2000)
    served.wait_for("started")
    other.send(2, 3)
    other.wait_for_state(3, "PENDING")
    one.send(1)
    assert set(one.done(1).values()) | set(other.done(3).values()) == {"SUCCEEDED"}
    assert [words[1] for words in served.of("started")] == ["2000", "1", "2", "3"]


@pytest.mark.long
def test_under_preemption_a_higher_goal_ends_a_lower_one(ros1, programs):
    _, served, one, other = connect(guarded(ros1, programs, PolicyName.PREEMPTION))
    other.send(LONG)
    served.wait_for("started")
    one.send(2000)
    assert other.done(1) == {1: "PREEMPTED"}
    served.wait_for("started", 2)
    other.send(1)
    assert other.done(2)[2] == "REJECTED"
    assert other.text(2)
    assert one.done(1) == {1: "SUCCEEDED"}


def test_a_blocked_client_is_told_so(ros1, programs):
    plan = action_plan(PolicyName.BLOCK, TWO)
    (grcn,) = plan.grcn
    one, other = grcn.flows
    plan = replace(plan, grcn=(replace(grcn, flows=(one, replace(other, block=True))),))
    _, served, one, other = connect(Act(ros1, programs, plan))
    other.send(LONG)
    assert other.done(1) == {1: "REJECTED"}
    assert "block" in other.text(1)
    one.send(1)
    assert one.done(1) == {1: "SUCCEEDED"}
    assert sum(served.executed().values()) == 1


@pytest.mark.long
def test_a_full_queue_refuses_and_what_waits_too_long_is_recalled(ros1, programs):
    settings = {"queue_size": 2, "max_age": SECOND // 2}
    _, served, one, other = connect(guarded(ros1, programs, **settings))
    one.send(3000)
    served.wait_for("started")
    other.send(1, 2, 3)
    done = other.done(3)
    assert sorted(done.values()) == ["RECALLED", "RECALLED", "REJECTED"]
    assert all(other.text(n) for n in done)
    assert one.done(1) == {1: "SUCCEEDED"}
    assert len(served.executed()) == 1


def test_a_cancel_never_waits_and_touches_only_its_client_s_goals(two):
    act, served, one, other = two
    one.send(LONG)
    served.wait_for("started")
    other.send(LONG, LONG)
    other.wait_for_state(2, "PENDING")
    other.tell("cancel 1")
    assert other.done(1) == {1: "RECALLED"}
    other.tell("cancel_all")
    assert other.done(2) == {1: "RECALLED", 2: "RECALLED"}
    other.tell("cancel_all")
    cancels = f"/rtron{ACT}/cancel/flow2"
    wait_for(lambda: act.ros1.received(GUARD, cancels) == 3, what="all cancels")
    other.send(1)
    other.wait_for_state(3, "PENDING")
    one.goes_on()
    one.tell("cancel_all")
    assert one.done(1) == {1: "PREEMPTED"}
    assert other.done(3)[3] == "SUCCEEDED"


@pytest.mark.long
def test_without_a_server_goals_are_refused(two):
    act, served, one, _ = two
    kill_server(act, served)
    one.send(1)
    assert one.done(1) == {1: "REJECTED"}
    assert one.text(1)

"""Goal ids, cancels and servers as nobody should send or write them."""

import pytest
from action_app import ACTIVE, FOREIGN, GUARD, NEVER, REJECTED, SUCCEEDED, Act, action_plan
from harness import wait_for

from rtron.vocabulary import SECOND, PolicyName

pytestmark = pytest.mark.ros1
TWO = ("/one", "/raw")
LONG = 60_000
FAR = 4_000_000_000


def connect(ros1, programs, flow="flow2", **settings):
    """Return a guarded action, its server, a client, and one that speaks by hand."""
    policy = settings.pop("policy", PolicyName.FIFO_QUEUE)
    act = Act(ros1, programs, action_plan(policy, TWO, **settings))
    served = act.server()
    one, raw = act.client(name="/one"), act.raw("/raw", flow)
    one.wait_for("connected")
    wait_for(lambda: raw.rows("ready"), what="the client that speaks by hand")
    return act, served, one, raw


@pytest.fixture
def approved(ros1, programs):
    return connect(ros1, programs)


@pytest.fixture
def stranger(ros1, programs):
    return connect(ros1, programs, flow=None)


def received(act, topic, count):
    wait_for(lambda: act.ros1.received(GUARD, topic) >= count, what=f"{count} on {topic}")


def ids_of_results(raw):
    return {row["id"] for row in raw.rows("result")}


def begin(served, one):
    """Let the server begin a long goal of /one; return its id."""
    one.send(LONG)
    ((goal_id, _),) = [line.words for line in served.wait_for("started")]
    return goal_id


def assert_untouched_until_cancelled(served, one):
    one.goes_on()
    assert not served.of("cancelled")
    one.tell("cancel 1")
    one.send(1)
    assert one.done(2) == {1: "PREEMPTED", 2: "SUCCEEDED"}


@pytest.mark.long
def test_an_empty_id_gets_a_name_and_a_goal_that_comes_twice_runs_once(approved):
    _, served, _, raw = approved
    raw.tell({"id": "", "value": 1}, {"id": "", "value": 1})
    raw.tell(*[{"id": "twice", "value": 2}] * 3)
    raw.tell({"id": "last", "value": 3})
    rows = raw.wait_for_result(4)
    wait_for(lambda: "last" in [row["id"] for row in raw.rows("result")], what="the last result")
    assert len({row["id"] for row in rows} - {""}) == 4
    assert served.executed()["twice"] == 1
    assert len(served.executed(1)) == 2
    raw.tell({"id": "twice", "value": 2}, {"id": "end", "value": 4})
    wait_for(lambda: "end" in served.executed(), what="a later goal")
    assert served.executed()["twice"] == 1


@pytest.mark.long
def test_ids_that_are_long_or_no_words(approved):
    _, served, _, raw = approved
    odd = "a b\n\x00ä%"
    raw.tell({"id": "x" * 1_000_000, "value": FOREIGN}, {"id": odd, "value": 2})
    raw.tell({"id": "last", "value": 1})
    wait_for(lambda: "last" in [row["id"] for row in raw.rows("result")], what="the last result")
    ends = {row["id"]: row["status"] for row in raw.rows("result")}
    assert ends[odd] == ends["last"] == SUCCEEDED
    assert not served.executed(FOREIGN)
    assert set(ends.values()) <= {SUCCEEDED, REJECTED}


def test_a_client_cannot_use_or_cancel_the_goal_of_another(approved):
    act, served, one, raw = approved
    taken = begin(served, one)
    raw.tell({"id": taken, "value": FOREIGN}, {"id": taken}, {"id": ""})
    raw.tell({"id": "", "stamp": FAR}, {"id": taken, "stamp": FAR})
    received(act, "/rtron/act/cancel/flow2", 4)
    received(act, "/rtron/act/goal/flow2", 1)
    assert_untouched_until_cancelled(served, one)
    assert not served.executed(FOREIGN)


def test_a_stranger_can_do_nothing(stranger):
    act, served, one, raw = stranger
    taken = begin(served, one)
    for goal_id in (taken, "", "its own"):
        raw.tell({"id": goal_id, "value": FOREIGN}, {"id": goal_id})
        raw.tell({"id": goal_id, "stamp": FAR})
    received(act, "/act/cancel", 6)
    received(act, "/act/goal", 3)
    assert_untouched_until_cancelled(served, one)
    assert not served.executed(FOREIGN)
    wait_for(lambda: ids_of_results(raw) == set(one.results()), what="the results of one alone")


@pytest.mark.long
def test_a_goal_of_an_earlier_time_is_served_too(approved):
    """A SimpleActionServer refuses stamps before that of its last goal; a queue reorders them."""
    _, _, one, raw = approved
    one.send(1)
    one.done(1)
    raw.tell({"id": "old", "value": 1, "stamp": 1}, {"id": "future", "value": 1, "stamp": FAR})
    raw.tell({"id": "older", "value": 1, "stamp": 1})
    ends = {row["id"]: row["status"] for row in raw.wait_for_result(4)}
    assert set(ends.values()) == {SUCCEEDED}
    one.send(1)
    assert one.done(2)[2] == "SUCCEEDED"


@pytest.mark.long
def test_a_flow_that_floods_touches_no_goal_of_others(ros1, programs):
    plan = action_plan(PolicyName.PRIORITY_QUEUE, ("/one", "/stranger"), queue_size=20)
    act = Act(ros1, programs, plan)
    served = act.server()
    one = act.client("cpp", name="/one")
    one.wait_for("connected")
    act.flood(flow="flow2")
    received(act, "/rtron/act/goal/flow2", 100)
    one.tell(*["goal 2", "wait 4"] * 50)
    assert set(one.done(50).values()) == {"SUCCEEDED"}
    assert set(served.executed(2).values()) == {1}
    assert len(served.executed(2)) == 50


@pytest.mark.long
def test_a_server_that_never_answers_is_waited_for_no_longer_than_the_plan_says(ros1, programs):
    plan = action_plan(PolicyName.FIFO_QUEUE, TWO, max_hold=2 * SECOND)
    act = Act(ros1, programs, plan)
    served = act.server(kind="queue")
    one, other = act.client(name="/one"), act.client("cpp", name="/raw", flow="flow2")
    one.wait_for("connected")
    other.wait_for("connected")
    one.send(NEVER)
    served.wait_for("started")
    one.tell("cancel 1")
    other.send(1)
    sent = other.wait_for("sent")[0].time
    assert served.wait_for("taken", 2)[1].time - sent > SECOND
    assert not one.of("done")
    served.process.kill()
    assert one.done(1) == {1: "ABORTED"}
    assert other.done(1) == {1: "ABORTED"}


def with_giant(ros1, programs, count, state, max_age=SECOND):
    """Return a guarded action whose server tells of so many goals, and a client."""
    plan = action_plan(PolicyName.FIFO_QUEUE, TWO, max_age=max_age)
    act = Act(ros1, programs, plan)
    act.giant_server(count, state)
    return act, act.client("cpp", name="/one")


@pytest.mark.long
def test_a_server_that_tells_of_thousands_of_goals_that_are_over_serves_others(ros1, programs):
    _, one = with_giant(ros1, programs, 10_000, SUCCEEDED, 10 * SECOND)
    one.wait_for("connected")
    one.send(1, 2, 3)
    assert set(one.done(3).values()) == {"SUCCEEDED"}
    one.wait_for("result", 3)
    assert set(one.results().values()) == {1}


@pytest.mark.long
def test_a_server_that_works_on_thousands_of_goals_is_busy(ros1, programs):
    _, one = with_giant(ros1, programs, 10_000, ACTIVE)
    one.wait_for("connected")
    one.send(1)
    assert one.done(1)[1] in {"REJECTED", "RECALLED"}
    assert one.text(1)


@pytest.mark.long
def test_a_status_that_is_longer_than_any_is_not_taken(ros1, programs):
    act, one = with_giant(ros1, programs, 50_000, ACTIVE)
    received(act, "/rtron/act/status/server", 3)
    assert act.guard_pid()
    assert not one.of("connected")

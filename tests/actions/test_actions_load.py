"""A thousand goals of three clients in random order, while a stranger floods."""

from random import Random

import pytest
from action_app import ASKED, FOREIGN, GUARD, Act, action_plan
from harness import wait_for

from rtron.vocabulary import SECOND, PolicyName

pytestmark = pytest.mark.ros1
CLIENTS = (("/one", "py", 333), ("/other", "py", 333), ("/third", "cpp", 334))
LONGEST_MS = 4
OPEN = 100
PATIENT = 60 * SECOND
LATE = SECOND // 4
LIMIT_S = 60
FLOOD = 1000
QUEUE_PARAMETERS = ("/actionlib_client_pub_queue_size", "/act/actionlib_client_pub_queue_size")


def start_clients(act):
    names = enumerate(CLIENTS, 1)
    clients = [act.client(lang, name=name, flow=f"flow{n}") for n, (name, lang, _) in names]
    for client in clients:
        client.wait_for("connected")
    return clients


def send_all(clients):
    """Send goals of random length; so many of each client's are open at once."""
    random = Random(1)
    for client, (_, _, count) in zip(clients, CLIENTS, strict=True):
        goals = (f"goal {random.randint(1, LONGEST_MS)}" for _ in range(count))
        client.tell(*(line for goal in goals for line in (goal, f"wait {OPEN - 1}")))


def number_of(goal_id):
    """Return the client and the number that actionlib writes into an id."""
    name, number, _ = goal_id.rsplit("-", 2)
    return name, int(number)


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
    for parameter in QUEUE_PARAMETERS:
        ros1.ask(ros1.uri, "setParam", parameter, 2 * OPEN)
    plan = action_plan(policy, [name for name, *_ in CLIENTS], max_age=max_age)
    act = Act(ros1, programs, plan)
    served = act.server(server)
    clients = start_clients(act)
    act.flood()
    wait_for(lambda: ros1.received(GUARD, "/act/goal") > FLOOD / 10, what="the stranger")
    send_all(clients)
    counts = [count for *_, count in CLIENTS]
    done = {c.name: c.done(n, LIMIT_S) for c, n in zip(clients, counts, strict=True)}
    assert [len(done[client.name]) for client in clients] == counts
    ends = {status for each in done.values() for status in each.values()}
    assert ends == ({"SUCCEEDED"} if max_age == PATIENT else {"SUCCEEDED", "RECALLED"})
    assert sum(ros1.received(GUARD, f"/act/{part}") for part in ASKED) > FLOOD
    assert_once(served, clients, done)
    assert_in_time(served, clients, max_age)


def assert_once(served, clients, done):
    """Assert that one result came for each goal, and that those which succeeded ran, once."""
    for client, (_, _, count) in zip(clients, CLIENTS, strict=True):
        client.wait_for("result", count)
        assert set(client.results().values()) == {1}
        assert len(client.results()) == len(client.of("done")) == count
    executed = served.executed()
    assert set(executed.values()) == {1}
    assert not served.executed(FOREIGN)
    ended = {(name, n): status for name, each in done.items() for n, status in each.items()}
    ran = {number_of(goal_id) for goal_id in executed}
    assert ran == {goal for goal, status in ended.items() if status == "SUCCEEDED"}


def assert_in_time(served, clients, max_age):
    """Assert that no goal was started when it had waited, as its client was told, for too long."""
    known = {client.name: client.known_at() for client in clients}
    for line in served.all("started"):
        name, number = number_of(line.words[0])
        assert line.time - known[name][number] <= max_age + LATE

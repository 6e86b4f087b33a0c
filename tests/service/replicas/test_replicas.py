"""What happens at one replica reaches guards and people at the other."""

import httpx
from harness import wait_for
from incident_reports import a_report

from rtron.service.collector.close_codes import CloseCode
from rtron.vocabulary import Alarm, AlarmKind
from rtron.wire.common.link_protocol import IncidentSaved, IncidentStored


def test_a_stop_reaches_a_guard_of_another_replica(replicas, people, connect_guard, car):
    guard = connect_guard(replicas, 0, car)
    wait_for(lambda: people[1].robot(car)["connected"])
    answer = people[1].stop(car, "smoke").json()
    assert (answer["outcome"], answer["connected"]) == ("pending", True)
    stop = guard.receive_settings().stop
    assert (stop.by, stop.reason) == ("token:person", "smoke")
    guard.answer()
    for person in people:
        wait_for(lambda person=person: person.robot(car)["outcome"] == "applied")


def test_a_stop_of_many_robots_reaches_each_at_its_replica(replicas, people, connect_guard, car):
    names = [f"{car}.{number}" for number in range(6)]
    guards = [connect_guard(replicas, number % 2, name) for number, name in enumerate(names)]
    guards.pop().close()
    for person in people:
        wait_for(lambda person=person: not person.robot(names[-1])["connected"])
        for name in names[:-1]:
            wait_for(lambda person=person, name=name: person.robot(name)["connected"])
    body = {"robots": [*names, "nobody"], "reason": "smoke"}
    answer = people[1].ask("/robots/stop", "POST", **body).json()
    assert (answer["sent"], answer["waiting"]) == (names[:-1], names[-1:])
    assert answer["failed"] == {"nobody": "there is no such robot"}
    assert [guard.receive_settings().stop.reason for guard in guards] == ["smoke"] * 5


def test_settings_reach_a_guard_of_another_replica_in_order(replicas, people, connect_guard, car):
    guard = connect_guard(replicas, 0, car)
    for number, person in enumerate([*people, *people]):
        change = {
            "revision": number,
            "reason": "a test",
            "nodes": {"speed": {"max_vel_limit": 0.1 + number / 10}},
        }
        assert person.ask(f"/robots/{car}/settings", "PATCH", **change).status_code == 200
        limits = guard.receive_settings()
        assert limits.revision == number + 1
        assert limits.nodes["speed"].max_vel_limit == 0.1 + number / 10


def test_a_change_of_an_old_revision_is_refused_everywhere(replicas, people, connect_guard, car):
    connect_guard(replicas, 0, car)
    change = {"revision": 0, "reason": "a test", "nodes": {"speed": {"max_vel_limit": 0.1}}}
    answers = [person.ask(f"/robots/{car}/settings", "PATCH", **change) for person in people]
    assert [each.status_code for each in answers] == [200, 409]
    assert answers[1].json()["newest"] == answers[0].json()


def test_a_stop_for_a_robot_that_is_away_waits(replicas, people, connect_guard, car):
    guard = connect_guard(replicas, 0, car)
    guard.close()
    for person in people:
        wait_for(lambda person=person: not person.robot(car)["connected"])
        answer = person.stop(car).json()
        assert (answer["outcome"], answer["connected"]) == ("pending", False)
    assert connect_guard(replicas, 1, car).settings.stop.reason == "a test"


def test_every_replica_knows_what_robots_are_at(replicas, people, connect_guard, car):
    guard = connect_guard(replicas, 0, car, dry_run=True)
    connect_guard(replicas, 1, f"{car}.truck")
    guard.tell_state(fps={"eyes": 12.5}, overridden=("nul\0",))
    for person in people:
        wait_for(lambda person=person: person.robot(car)["state"])
        assert person.robot(car)["state"]["fps"] == {"eyes": 12.5}
        assert person.robot(car)["dry_run"]
        wait_for(lambda person=person: connected(person, car) == [car, f"{car}.truck"])
        assert person.ask(f"/robots?connected=false&text={car}").json() == []
    guard.close()
    for person in people:
        wait_for(lambda person=person: person.robot(car)["state"] is None)
        assert [
            each["name"] for each in person.ask(f"/robots?connected=false&text={car}").json()
        ] == [car]


def connected(person, text):
    robots = person.ask(f"/robots?connected=true&text={text}").json()
    return [each["name"] for each in robots]


def changes(robot, key):
    """Return a condition of messages that tell of a robot what differs under a key."""
    return lambda each: each["type"] == "robots" and key in each["robots"].get(robot, {})


def test_consoles_of_another_replica_see_what_happens(replicas, people, connect_guard, car):
    with people[1].console(car) as receive:
        guard = connect_guard(replicas, 0, car)
        assert receive(changes(car, "connected"))["robots"][car]["connected"]
        guard.tell_state(fps={"eyes": 1.0})
        assert receive(lambda each: each["type"] == "state")["state"]["fps"] == {"eyes": 1.0}
        guard.store_events("run", [1, 2])
        seen = [receive(lambda each: each["type"] == "event")["event"] for _ in range(2)]
        assert [(each["robot"], each["reason"]) for each in seen] == [
            (car, "event 1"),
            (car, "event 2"),
        ]
        people[0].stop(car)
        assert receive(lambda each: each["type"] == "settings")["view"]["outcome"] == "pending"
        guard.receive_settings()
        guard.answer()
        assert receive(lambda each: each["type"] == "settings")["view"]["outcome"] == "applied"
        guard.close()
        assert not receive(
            lambda each: changes(car, "connected")(each) and not each["robots"][car]["connected"]
        )["robots"][car]["connected"]


def test_a_shift_has_people_at_several_replicas(replicas, people, connect_guard, car):
    guard = connect_guard(replicas, 0, car)
    alarm = Alarm(kind=AlarmKind.DRIFT, reason="it is another node", node="/base")
    guard.tell_state(alarms=(alarm,))
    for person in people:
        wait_for(lambda person=person: person.robot(car)["alarms"])
    with people[1].console(car) as receive:
        seen = {"robot": car, "kind": "drift", "node": "/base"}
        for person, note in zip(people, ("the base was changed", "and I go there"), strict=True):
            answer = person.ask("/acknowledgements", "POST", alarms=[seen], note=note)
            assert answer.json()["acknowledged"] == 1
            (told,) = receive(changes(car, "acknowledged"))["robots"][car]["acknowledged"]
            assert told["note"] == note
        people[0].ask("/handovers", "POST", text="the base is new")
        receive(lambda each: each["type"] == "handover")
        notes = people[1].ask("/handovers").json()["handovers"]
        assert notes[0]["situation"]["acknowledged"] == 1


def test_an_incident_of_a_robot_is_told_and_found_at_every_replica(
    replicas, people, connect_guard, car
):
    guard = connect_guard(replicas, 0, car)
    with people[1].console(car) as receive:
        guard.send(IncidentSaved(report=a_report()))
        assert guard.receive(IncidentStored).name == a_report().name
        receive(lambda each: each["type"] == "incident")
        (found,) = people[1].ask(f"/incidents?robot={car}").json()["incidents"]
    assert (found["robot"], found["name"]) == (car, a_report().name)


def test_a_rollout_is_told_at_every_replica(replicas, people, connect_guard, car):
    connect_guard(replicas, 0, car)
    for person in people:
        wait_for(lambda person=person: person.robot(car)["connected"])
    new = {"robots": {"names": [car]}, "nodes": {"speed": {"max_vel_limit": 0.1}}, "wait": 3600}
    with people[0].console(car) as here, people[1].console(car) as there:
        id = people[1].ask("/rollouts", "POST", reason="a test", **new).json()["id"]
        for receive in (here, there):
            assert receive(lambda each: each["type"] == "rollout")["id"] == id
        people[0].ask(f"/rollouts/{id}/cancel", "POST", reason="a test", keep=True)
        for receive in (here, there):
            assert receive(lambda each: each["type"] == "rollout")["id"] == id


def test_the_newest_connection_of_a_robot_stays(replicas, people, connect_guard, car):
    first = connect_guard(replicas, 0, car)
    wait_for(lambda: people[1].robot(car)["connected"])
    second = connect_guard(replicas, 1, car)
    assert first.close_code() == CloseCode.REPLACED
    people[0].stop(car)
    assert second.receive_settings().stop
    for person in people:
        wait_for(lambda person=person: person.robot(car)["connected"])


def test_events_that_come_again_elsewhere_are_stored_once(replicas, people, connect_guard, car):
    assert connect_guard(replicas, 0, car).store_events("run", [1, 2, 3]) == 3
    assert connect_guard(replicas, 1, car).store_events("run", [2, 3, 4]) == 4
    for person in people:
        events = person.ask(f"/events?robot={car}").json()["events"]
        assert [each["reason"] for each in events] == [f"event {n}" for n in (4, 3, 2, 1)]


def test_one_of_the_replicas_makes_the_first_admin(replicas):
    wait_for(lambda: any("password" in each.log.read_text() for each in replicas))
    for each in replicas:
        assert httpx.get(f"{each.url}/healthz").status_code == 200
    assert sum("first start" in each.log.read_text() for each in replicas) == 1

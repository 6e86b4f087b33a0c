"""Replicas that are killed, cut off, or whose database is full or slow."""

from itertools import cycle

import pytest
from database_faults import DatabaseFaults
from harness import wait_for

from rtron.service.collector.close_codes import CloseCode


@pytest.fixture
def replicas(own_replicas):
    return own_replicas


@pytest.fixture
def faults(replicas):
    return DatabaseFaults(replicas.url)


@pytest.fixture
def guard(replicas, people, connect_guard):
    """Give a guard of the first replica, of which the second one knows."""
    connected = connect_guard(replicas, 0, "car")
    wait_for(lambda: people[1].robot("car")["connected"])
    return connected


def test_a_replica_that_is_killed_has_no_guards(replicas, people, guard, connect_guard):
    replicas[0].kill()
    wait_for(lambda: not people[1].robot("car")["connected"])
    again = connect_guard(replicas, 1, "car")
    assert people[1].stop("car").json()["connected"]
    assert again.receive_settings().stop


def test_nothing_acknowledged_is_lost_or_doubled_by_kills(replicas, people, connect_guard):
    acknowledged = 0
    for number, index in zip(range(4), cycle((0, 1)), strict=False):
        guard = connect_guard(replicas, index, "car")
        acknowledged = guard.store_events("run", range(max(1, acknowledged - 5), acknowledged + 50))
        assert people[index].stop("car", f"kill {number}").status_code == 200
        replicas[index].kill()
        replicas[index].start()
        replicas[index].wait_ready()
    events = people[0].ask("/events?robot=car&limit=1000").json()["events"]
    reasons = [each["reason"] for each in events]
    assert reasons == [f"event {number}" for number in range(acknowledged, 0, -1)]
    history = people[0].ask("/robots/car/settings/history").json()
    assert [each["reason"] for each in history[:4]] == [f"kill {n}" for n in (3, 2, 1, 0)]


def test_a_stop_that_was_not_heard_of_is_read(replicas, people, guard, faults):
    with faults.cut_off("car"):
        assert people[1].stop("car").json()["outcome"] == "pending"
    assert guard.receive_settings().stop.reason == "a test"


def test_a_replica_that_is_cut_off_sends_its_guards_away(replicas, people, guard, faults):
    with faults.cut_off("car"):
        assert guard.close_code() == CloseCode.GOING_AWAY
        assert people[0].readiness() == 503
    wait_for(lambda: people[0].readiness() == 200)


def test_a_full_disk_refuses_events_and_neither_guards_nor_stops(
    replicas, people, guard, connect_guard, faults
):
    with faults.full_disk():
        for person in people:
            wait_for(lambda person=person: person.readiness() == 200)
            assert person.readiness("/readyz") == 503
        answer = people[1].stop("car", "smoke")
        assert answer.status_code == 503
        assert "the stop is sent, but not stored" in answer.json()["error"]
        assert guard.receive_settings().stop.reason == "smoke"
        guard.close()
        again = connect_guard(replicas, 0, "car")
        assert again.settings.stop.reason == "smoke"
    revision = again.settings.revision
    change = {"revision": revision, "reason": "a test", "nodes": {"speed": {"max_vel_limit": 0.1}}}
    wait_for(lambda: people[0].ask("/robots/car/settings", "PATCH", **change).status_code != 503)
    wait_for(lambda: (people[1].robot("car")["stop"] or {}).get("reason") == "smoke")


def test_stops_of_many_robots_that_cannot_be_stored_are_sent_by_whoever_has_them(
    replicas, people, guard, connect_guard, faults
):
    truck, gone = connect_guard(replicas, 1, "truck"), connect_guard(replicas, 1, "gone")
    gone.close()
    wait_for(lambda: not people[1].robot("gone")["connected"])
    with faults.full_disk():
        for person in people:
            wait_for(lambda person=person: person.readiness() == 200)
        body = {"robots": ["car", "truck", "gone"], "reason": "smoke"}
        answer = people[1].ask("/robots/stop", "POST", **body).json()
        assert (answer["sent"], answer["waiting"]) == ([], [])
        told = {robot: why.partition(":")[0] for robot, why in answer["failed"].items()}
        assert told == {
            "car": "the stop is sent, but not stored",
            "truck": "the stop is sent, but not stored",
            "gone": "the stop is neither sent nor stored",
        }
        for each in (guard, truck):
            assert each.receive_settings().stop.reason == "smoke"


def test_a_stop_that_nobody_can_send_is_told_as_such(replicas, people, guard, faults):
    guard.close()
    wait_for(lambda: not people[1].robot("car")["connected"])
    with faults.full_disk():
        wait_for(lambda: people[1].readiness() == 200)
        answer = people[1].stop("car")
        assert answer.status_code == 503
        assert "the stop is neither sent nor stored" in answer.json()["error"]


def test_a_slow_database_holds_up_no_stop(replicas, people, guard, connect_guard, faults):
    truck = connect_guard(replicas, 1, "truck")
    with faults.slow_events():
        truck.send_events("run", [1])
        guard.send_events("run", [1])
        assert people[1].stop("car").status_code == 200
        assert guard.receive_settings().stop
    assert guard.stored_number() == truck.stored_number() == 1

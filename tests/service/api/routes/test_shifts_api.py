"""Acknowledged alarms and handover notes, over HTTP, on each kind of database."""

import httpx
import pytest
from controller_setup import hello, plan
from harness import LIMIT_S, wait_for
from service_app import TLS, AccountFactory, FakeLink, serve_in_thread

from rtron.service.config import ServiceConfig
from rtron.service.server.app import create_app
from rtron.service.store.accounts.users import get_user, set_groups
from rtron.service.store.events import EventBatch
from rtron.service.store.robots import find_robot
from rtron.vocabulary import Alarm, AlarmKind, EventKind, GuardEvent, GuardState

ALARM = Alarm(kind=AlarmKind.INTRUSION, reason="a stranger speaks", topic="/cmd_vel", peer="/evil")
OTHER = Alarm(kind=AlarmKind.DRIFT, reason="it is another node", node="/base")


class Desk:
    """A service with the robot r2, as people of a shift use it."""

    def __init__(self, app, client):
        self.app, self.service, self.client = app, app.state.service, client
        self.people, self.link, self.number = AccountFactory(self.service), FakeLink(), 0
        self.service.controller.handle_hello("r2", hello(plan()))
        self.service.hub.register("r2", self.link, dry_run=False)

    def alarms(self, *alarms):
        state = GuardState(at=5, revision=0, alarms=alarms)
        self.service.hub.set_state("r2", self.link, state)

    def call(self, method, path, *, who="eva", **keys):
        headers = self.people.session_headers(who, "end_user")
        return self.client.request(method, f"/api/v1{path}", headers=headers, **keys)

    def acknowledge(self, *alarms, note="seen it", who="eva"):
        listed = [reference(each) for each in alarms]
        body = {"alarms": listed, "note": note}
        answer = self.call("POST", "/acknowledgements", who=who, json=body)
        assert answer.status_code == 200, answer.text
        return answer.json()

    def acknowledged(self):
        """Return who has seen what, and the note, of the robot's alarms."""
        found = self.call("GET", "/robots/r2").json()["acknowledged"]
        return [(each["by"], each["kind"], each["note"]) for each in found]

    def tell(self, kind, alarm, run="run1"):
        """Store an event of the guard about an alarm, as the collector does."""
        self.number += 1
        values = {
            "kind": alarm.kind.value, "reason": alarm.reason, "topic": alarm.topic,
            "node": alarm.node, "peer": alarm.peer,
        }  # fmt: skip
        event = GuardEvent(run=run, number=self.number, at=7, kind=kind, values=values)
        with self.service.database.session() as session:
            robot, _ = find_robot(session, "r2")
        self.app.state.collector._store_batches([EventBatch(robot.id, "r2", [event])])


def reference(alarm, robot="r2"):
    return {
        "robot": robot, "kind": alarm.kind.value, "topic": alarm.topic, "node": alarm.node,
        "peer": alarm.peer,
    }  # fmt: skip


@pytest.fixture
def desk(where, clock):
    app = create_app(ServiceConfig(database=where), clock, clock)
    with (
        serve_in_thread(app) as port,
        httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=LIMIT_S, verify=TLS) as client,
    ):
        yield Desk(app, client)


def test_an_alarm_is_seen_by_somebody_with_a_note(desk):
    desk.alarms(ALARM, OTHER)
    assert desk.acknowledge(ALARM, note="the engineer is there") == {
        "acknowledged": 1,
        "gone": [],
        "failed": {},
    }
    assert desk.acknowledged() == [("eva", "intrusion", "the engineer is there")]


@pytest.mark.parametrize("kind", [EventKind.ALARM, EventKind.ALARM_CLEARED])
def test_it_ends_when_the_guard_tells_of_the_alarm_again(desk, clock, kind):
    desk.alarms(ALARM, OTHER)
    desk.acknowledge(ALARM, OTHER)
    heard = []
    desk.service.hub.broadcast = heard.append
    clock.sleep(60)
    desk.tell(kind, ALARM)
    assert desk.acknowledged() == [("eva", "drift", "seen it")]
    assert [each["change"]["acknowledged"][0]["kind"] for each in heard] == ["drift"]
    page = desk.call("GET", "/acknowledgements").json()["acknowledgements"]
    assert {each["kind"]: each["ended"] for each in page} == {
        "intrusion": clock(), "drift": None
    }  # fmt: skip


def test_who_is_limited_to_a_group_acknowledges_no_alarm_of_another(desk):
    desk.alarms(ALARM)
    desk.people.session_headers("tom", "end_user")
    with desk.service.database.session() as session:
        set_groups(get_user(session, "tom"), ["hall-a"])
    assert desk.acknowledge(ALARM, who="tom") == {
        "acknowledged": 0,
        "gone": [],
        "failed": {"r2": "r2 is in no group of tom"},
    }
    assert desk.acknowledged() == []
    admin = desk.people.session_headers("root", "admin")
    line = desk.client.get("/api/v1/audit", headers=admin).json()["entries"][0]
    assert (line["who"], line["action"], line["target"]) == ("tom", "acknowledge", "r2")
    assert line["outcome"] == "refused: r2 is in no group of tom"
    desk.client.put("/api/v1/robots/r2/labels", headers=admin, json={"labels": ["hall-a"]})
    assert desk.acknowledge(ALARM, who="tom")["acknowledged"] == 1


def test_another_alarm_and_other_events_end_nothing(desk):
    desk.alarms(ALARM)
    desk.acknowledge(ALARM)
    desk.tell(EventKind.ALARM, OTHER)
    desk.tell(EventKind.VERDICT, ALARM)
    assert len(desk.acknowledged()) == 1


def test_the_newest_who_has_seen_it_counts(desk):
    desk.alarms(ALARM)
    desk.acknowledge(ALARM, who="eva")
    desk.acknowledge(ALARM, who="mary", note="and I go there")
    assert desk.acknowledged() == [("mary", "intrusion", "and I go there")]


def test_what_is_no_alarm_any_more_is_told(desk):
    desk.alarms(ALARM)
    result = desk.acknowledge(ALARM, OTHER)
    assert (result["acknowledged"], result["gone"]) == (1, [reference(OTHER)])
    desk.service.hub.unregister("r2", desk.link)  # replicas tell one another a moment later
    wait_for(lambda: desk.acknowledge(ALARM)["acknowledged"] == 0, what="the robot's end")


def test_names_of_strangers_are_acknowledged_as_they_are(desk):
    odd = Alarm(kind=AlarmKind.IMPOSTOR, reason="", topic="/\0\u202e", node="n" * 1000, peer="';--")
    desk.alarms(odd)
    listed = reference(odd) | {"node": odd.node[:300], "topic": "/\ufffd\u202e"}
    body = {"alarms": [listed], "note": "a strange name"}
    assert desk.call("POST", "/acknowledgements", json=body).json()["acknowledged"] == 1
    assert len(desk.acknowledged()) == 1
    desk.tell(EventKind.ALARM_CLEARED, odd)
    assert desk.acknowledged() == []


NO_ACKNOWLEDGEMENTS = (
    {"alarms": [], "note": "seen it"},
    {"alarms": [reference(ALARM)], "note": ""},
    {"alarms": [reference(ALARM)], "note": "\u200b\u200b\u200b"},
    {"alarms": [reference(ALARM)] * 201, "note": "seen it"},
    {"alarms": [reference(ALARM) | {"by": "somebody else"}], "note": "seen it"},
)
NO_NOTES = ("", "  ", "x" * 4001)


def test_what_is_no_acknowledgement_or_note_is_refused(desk):
    desk.alarms(ALARM)
    for body in NO_ACKNOWLEDGEMENTS:
        assert desk.call("POST", "/acknowledgements", json=body).status_code == 422, body
    assert desk.acknowledged() == []
    for text in NO_NOTES:
        assert desk.call("POST", "/handovers", json={"text": text}).status_code == 422, text[:9]
    assert desk.call("GET", "/handovers").json()["handovers"] == []


def test_acknowledging_is_in_the_audit_log(desk):
    desk.alarms(ALARM)
    desk.acknowledge(ALARM, note="the engineer is there")
    headers = desk.people.session_headers("root", "admin")
    entry = desk.client.get("/api/v1/audit", headers=headers).json()["entries"][0]
    assert (entry["who"], entry["action"], entry["target"]) == ("eva", "acknowledge", "r2")
    assert entry["detail"]["note"] == "the engineer is there"


def test_notes_are_kept_with_what_was_so(desk, clock):
    desk.alarms(ALARM, OTHER)
    desk.acknowledge(ALARM)
    desk.call("POST", "/robots/r2/stop", json={"reason": "smoke"})
    text = "the light in hall 3 is broken\nr2 waits for a wheel"
    answer = desk.call("POST", "/handovers", json={"text": f"  {text} "})
    assert answer.status_code == 201
    clock.sleep(60)
    desk.call("POST", "/handovers", who="mary", json={"text": "all is well"})
    newest, first = desk.call("GET", "/handovers").json()["handovers"]
    assert (newest["by"], first["by"], first["text"]) == ("mary", "eva", text)
    assert first["situation"] == {
        "robots": 1, "connected": 1, "stopped": 1, "overridden": 0, "alarms": 2, "acknowledged": 1
    }  # fmt: skip


def test_older_ones_come_page_by_page(desk):
    notes = [f"note {number}" for number in range(5)]
    desk.alarms(ALARM)
    for note in notes:
        desk.call("POST", "/handovers", json={"text": note})
        desk.acknowledge(ALARM, note=note)
    for path, field in (("handovers", "text"), ("acknowledgements", "note")):
        found, query = [], {"limit": 2}
        while query.get("before", "newest") is not None:
            page = desk.call("GET", f"/{path}", params=query).json()
            found += [each[field] for each in page[path]]
            query["before"] = page["next"]
        assert found == notes[::-1], path

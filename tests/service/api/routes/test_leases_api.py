"""Leases over HTTP: all see who is in command, and who may changes it, by name and reason."""

import pytest
from harness import wait_for
from leased_base import AGENT, NAV, PLAN, TELEOP, TTL
from leased_guard import REMOTE, LeasedGuard

from rtron.service.controller import command_dispatcher
from rtron.service.store.accounts.users import get_user, set_groups
from rtron.wire.common.link_protocol import CommandResponse

LEASES = "/api/v1/robots/r1/leases"


@pytest.fixture
def guard_class():
    return LeasedGuard


@pytest.fixture
def change(client, guard, ann):
    """Ask for something in the name of ann, who sees what is so now."""

    def change(do, to="", headers=ann, **body):
        reason = {} if do == "renew" else {"reason": "the door is shut"}
        body = {"do": do, "to": to, "grant": guard.held().grant, **reason, **body}
        answer = client.post(f"{LEASES}/base", headers=headers, json=body)
        return answer.status_code, answer.json()

    return change


def lease(client, headers):
    (found,) = client.get(LEASES, headers=headers).json()
    return found


def test_everybody_sees_who_may_command_and_who_does(client, people, guard):
    reader = people.token_headers("reader", "read")
    base = lease(client, reader)
    assert (base["name"], base["ttl"]) == ("base", TTL)
    assert base["topics"] == ["/cmd_vel", "/arm_vel"]
    assert [each["name"] for each in base["commanders"]] == [TELEOP, NAV, AGENT]
    assert (base["service"], base["permitted"]) == (REMOTE, False)
    assert base["status"]["holder"] == ""
    guard.ask(NAV, "acquire a goal has come")
    wait_for(lambda: lease(client, reader)["status"]["holder"] == NAV, what="the holder")
    status = lease(client, reader)["status"]
    assert (status["rank"], status["reason"]) == ("autonomy", "acquired: a goal has come")


def test_a_person_takes_over_by_rank_renews_and_ends(client, guard, ann, change, audit):
    guard.ask(NAV, "acquire a goal")
    assert lease(client, ann)["permitted"]
    status, answer = change("give", AGENT)
    assert status == 200
    assert "given by ann (remote_operator): the door is shut" in answer["reason"]
    assert guard.held().holder == AGENT
    assert change("renew") == (200, {"reason": "base is renewed for 2.00 s"})
    assert change("end")[0] == 200
    assert guard.held().holder == ""
    entries = [entry for entry in audit() if entry[1].startswith("lease.")]
    assert [entry[:3] for entry in reversed(entries)] == [
        (who, action, "r1/base")
        for asked in ("give", "renew", "end")
        for who, action in (("ann", f"lease.{asked}"), ("guard:r1", "lease.answer"))
    ]
    assert entries[-1][3] == "done"
    assert entries[-2][3].startswith("granted: base is granted to /agent (agent)")


def test_the_guard_refuses_by_rank_and_the_log_has_it(guard, change, audit):
    guard.ask(TELEOP, "acquire docking")
    status, answer = change("give", NAV)
    assert status == 409
    assert answer["error"].endswith("acquired: docking: ann (remote_operator) has no higher rank")
    assert guard.held().holder == TELEOP
    assert audit()[0][3].startswith("refused: /teleop (operator_on_site) holds base")


def test_what_has_changed_hands_meanwhile_is_looked_at_again(guard, change):
    seen = guard.held().grant
    guard.ask(AGENT, "acquire")
    status, answer = change("end", grant=seen)
    assert status == 409
    assert "has changed hands meanwhile" in answer["error"]
    assert guard.held().holder == AGENT


def test_who_held_it_before_is_in_the_events(client, guard, ann, change):
    guard.ask(NAV, "acquire a goal")
    change("give", AGENT)

    def holders():
        query = {"robot": "r1", "kind": "lease"}
        events = client.get("/api/v1/events", headers=ann, params=query).json()["events"]
        return [(each["publisher"], each["values"].get("rank")) for each in events]

    wait_for(lambda: len(holders()) == 2, what="the events")
    assert holders() == [(AGENT, "agent"), (NAV, "autonomy")]


@pytest.mark.parametrize("roles", [["admin"], []])
def test_who_has_not_the_role_changes_nothing(client, people, guard, change, roles):
    headers = people.session_headers("tim", *roles) if roles else people.token_headers("t", "read")
    assert change("give", AGENT, headers)[0] == 403
    assert (guard.commands, guard.held().holder) == ([], "")


def test_a_program_changes_nothing(people, guard, change, audit):
    headers = people.token_headers("script", "developer", "end_user")
    assert change("give", AGENT, headers)[0] == 403
    assert guard.commands == []
    assert audit()[0][3].startswith("refused: token:script")


def test_who_has_other_groups_changes_nothing(app, client, people, guard, change):
    headers = people.session_headers("tom", "end_user", "developer")
    with app.state.service.database.session() as session:
        set_groups(get_user(session, "tom"), ["hall-b"])
    assert not lease(client, headers)["permitted"]
    assert change("end", headers=headers)[0] == 403
    assert guard.commands == []


def test_a_plan_that_gives_people_no_rank_is_obeyed(client, connect, ann, audit):
    guard = connect(PLAN)
    assert (lease(client, ann)["service"], lease(client, ann)["permitted"]) == (None, False)
    body = {"do": "give", "to": NAV, "grant": 0, "reason": "a trial"}
    assert client.post(f"{LEASES}/base", headers=ann, json=body).status_code == 403
    assert client.post(f"{LEASES}/arm", headers=ann, json=body).status_code == 404
    assert guard.commands == []
    assert audit()[0][:3] == ("ann", "lease.give", "r1/arm")


def test_a_robot_that_is_not_known_or_not_connected(client, people, guard, ann):
    body = {"do": "give", "to": NAV, "grant": 0, "reason": "a trial"}
    assert client.get("/api/v1/robots/r2/leases", headers=ann).status_code == 404
    assert client.post("/api/v1/robots/r2/leases/base", headers=ann, json=body).status_code == 404
    guard.close()

    def refused():
        answer = client.post(f"{LEASES}/base", headers=ann, json=body)
        return answer.status_code == 503 and "is not connected" in answer.json()["error"]

    wait_for(refused, what="the end of the connection")
    assert lease(client, ann)["status"] is None


def test_a_guard_that_does_not_answer_is_not_waited_for_long(guard, change, monkeypatch, audit):
    monkeypatch.setattr(command_dispatcher, "_ANSWER_TIMEOUT_S", 0.2)
    guard.answer = None
    status, answer = change("give", NAV)
    assert (status, answer["error"]) == (503, "the guard of r1 does not answer")
    assert answer["help"].startswith("it may have done it all the same")
    assert audit()[0] == (
        "guard:r1",
        "lease.answer",
        "r1/base",
        "no answer: the guard of r1 does not answer",
    )


def test_what_a_guard_answers_is_cut_and_has_no_nul(guard, change, audit):
    long = "no\0" + "x" * 5000
    guard.answer = lambda command: CommandResponse(
        number=command.number, granted=False, reason=long
    )
    status, answer = change("give", NAV)
    assert (status, answer["error"]) == (409, "no\ufffd" + "x" * 997)
    assert audit()[0][3].startswith("refused: no\ufffdxxx")


def test_an_older_guard_is_asked_for_nothing(connect, client, ann):
    guard = connect(takes_lease_commands=False)
    body = {"do": "give", "to": NAV, "grant": 0, "reason": "a trial"}
    answer = client.post(f"{LEASES}/base", headers=ann, json=body)
    assert (answer.status_code, guard.commands) == (503, [])
    assert answer.json()["error"] == "the guard does not know such commands"


def test_names_and_reasons_that_turn_the_direction_are_kept_as_one_line(guard, change):
    status, answer = change("give", NAV, reason="well\u202e\n\x1b[2Jdone")
    assert status == 200
    assert answer["reason"].isprintable()
    assert guard.held().reason == "given by ann (remote_operator): well [2Jdone"

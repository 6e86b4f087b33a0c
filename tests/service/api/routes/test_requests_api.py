"""Requests of a bridge's clients over HTTP: seen by all, answered by whom the bridge names."""

import pytest
from asked_guard import AskedGuard
from harness import wait_for

from rtron.bridge.protocol.approvals import HOLDS_FOR, WAITS_FOR
from rtron.bridge.rights.document import Approvers
from rtron.service.controller import command_dispatcher
from rtron.service.store.accounts.users import get_user, set_groups

REQUESTS = "/api/v1/robots/r1/requests"
APPROVED = "request 1 of assistant, publish /goal, is approved by ann at the service"


@pytest.fixture
def guard_class():
    return AskedGuard


@pytest.fixture
def shown(client, ann):
    """Wait until the service knows so many requests, and return them."""

    def shown(count=1):
        def listed():
            return client.get(REQUESTS, headers=ann).json()["requests"]

        wait_for(lambda: listed()["count"] == count, what="the requests")
        return listed()["shown"]

    return shown


@pytest.fixture
def answer(client, ann):
    """Answer a request in the name of ann."""

    def answer(digest, do="approve", headers=ann, **body):
        body = {"do": do, "reason": "the corridor is free", **body}
        response = client.post(f"{REQUESTS}/{digest}", headers=headers, json=body)
        return response.status_code, response.json()

    return answer


def test_a_person_sees_what_is_asked_and_it_passes_once(
    client, people, guard, ann, shown, answer, audit
):
    assert "request 1 waits" in guard.ask_person()
    (request,) = shown()
    assert (request["client"], request["what"]) == ("assistant", "publish /goal")
    assert request["content"] == '{"pose":{"position":{"x":1,"y":3}}}'
    reader = people.token_headers("reader", "read")
    assert client.get(REQUESTS, headers=ann).json()["permitted"]
    assert not client.get(REQUESTS, headers=reader).json()["permitted"]
    assert client.get("/api/v1/robots/r1", headers=reader).json()["requests"] == 1
    assert answer(request["digest"]) == (200, {"reason": APPROVED})
    shown(0)
    assert guard.ask_person() == ""
    assert "request 2 waits" in guard.ask_person()
    after, before = audit()[:2]
    target = f"r1/{request['digest']}"
    assert before[:4] == ("ann", "request.approve", target, "done")
    assert after[:4] == ("guard:r1", "request.answer", target, f"granted: {APPROVED}")


def test_the_log_has_what_the_person_has_seen(client, people, guard, shown, answer):
    guard.ask_person()
    answer(shown()[0]["digest"], "refuse")
    admin = people.session_headers("ada", "admin")
    entries = client.get("/api/v1/audit", headers=admin).json()
    entries = entries["entries"] if isinstance(entries, dict) else entries
    (entry,) = [each for each in entries if each["action"] == "request.refuse"]
    assert entry["detail"] == {
        "client": "assistant",
        "what": "publish /goal",
        "content": '{"pose":{"position":{"x":1,"y":3}}}',
        "reason": "the corridor is free",
    }
    assert "ann at the service has refused request 1" in guard.ask_person()


def test_who_clicks_twice_approves_once(guard, shown, answer):
    guard.ask_person()
    (request,) = shown()
    assert answer(request["digest"])[0] == 200
    assert answer(request["digest"])[0] == 409
    assert guard.ask_person() == ""
    assert "request 2 waits" in guard.ask_person()


def test_an_old_click_approves_nothing_although_the_service_does_not_know_yet(
    guard, shown, answer, audit
):
    guard.ask_person()
    (request,) = shown()
    guard.passed = WAITS_FOR
    status, told = answer(request["digest"])
    assert (status, "does not wait any more" in told["error"]) == (409, True)
    assert len(guard.commands) == 1
    assert audit()[0][3].startswith("refused: this request does not wait any more")
    assert "request 2 waits" in guard.ask_person()
    assert answer(request["digest"])[0] == 409
    assert guard.waiting() == [2]


def test_an_approval_ends_after_a_minute(guard, shown, answer):
    guard.ask_person()
    assert answer(shown()[0]["digest"])[0] == 200
    guard.passed = HOLDS_FOR
    assert "request 2 waits" in guard.ask_person()


@pytest.mark.parametrize(
    ("name", "roles", "status"),
    [
        ("dora", ["developer"], 200),
        ("bob", ["developer"], 403),
        ("dora", ["admin"], 403),
        ("bob", ["admin"], 403),
    ],
)
def test_who_is_named_in_the_rights_of_the_bridge_answers(
    people, guard, shown, answer, name, roles, status
):
    guard.ask_person()
    (request,) = shown()
    assert answer(request["digest"], headers=people.session_headers(name, *roles))[0] == status
    assert bool(guard.commands) is (status == 200)


@pytest.mark.parametrize("approvers", [Approvers(), Approvers(names=("bob",))])
def test_rights_that_do_not_name_a_person_let_it_see_alone(
    connect, client, ann, shown, answer, audit, approvers
):
    guard = connect(approvers)
    guard.ask_person()
    (request,) = shown()
    assert not client.get(REQUESTS, headers=ann).json()["permitted"]
    status, told = answer(request["digest"])
    assert (status, told["error"]) == (403, "the rights of the bridge do not let you answer")
    assert (guard.commands, guard.waiting()) == ([], [1])
    assert audit()[0][:2] == ("ann", "request.approve")
    assert audit()[0][3].startswith("refused: the rights of the bridge")


@pytest.mark.parametrize("body", [{"by": "dora"}, {"roles": ["end_user"]}, {"reason": "  "}])
def test_who_one_is_is_not_said_by_the_body_and_a_reason_is(people, guard, shown, answer, body):
    guard.ask_person()
    headers = people.session_headers("bob", "developer")
    assert answer(shown()[0]["digest"], headers=headers, **body)[0] == 422
    assert guard.commands == []


def test_a_program_answers_nothing(people, guard, shown, answer, audit):
    guard.ask_person()
    headers = people.token_headers("script", "developer", "end_user")
    assert answer(shown()[0]["digest"], headers=headers)[0] == 403
    assert guard.commands == []
    assert audit()[0][3].startswith("refused: token:script")


def test_who_has_other_groups_answers_nothing(app, client, people, guard, shown, answer):
    guard.ask_person()
    (request,) = shown()
    headers = people.session_headers("tom", "end_user")
    with app.state.service.database.session() as session:
        set_groups(get_user(session, "tom"), ["hall-b"])
    assert not client.get(REQUESTS, headers=headers).json()["permitted"]
    assert answer(request["digest"], headers=headers)[0] == 403
    assert guard.commands == []


def test_a_bridge_that_does_not_answer(guard, shown, answer, audit, monkeypatch):
    monkeypatch.setattr(command_dispatcher, "_ANSWER_TIMEOUT_S", 0.2)
    guard.ask_person()
    (request,) = shown()
    guard.answer = None
    status, told = answer(request["digest"])
    assert (status, "look what waits now" in told["help"]) == (503, True)
    assert audit()[0][3].startswith("no answer: the guard of r1 does not answer")


def test_a_robot_that_is_not_known_or_away_or_older(client, connect, ann, shown, answer):
    digest = "0" * 64
    guard = connect(takes_approval_commands=False)
    assert client.get("/api/v1/robots/r2/requests", headers=ann).status_code == 404
    assert client.post(f"{REQUESTS}/x", headers=ann, json={}).status_code == 422
    assert answer(digest)[0] == 409
    guard.ask_person()
    status, told = answer(shown()[0]["digest"])
    assert (status, told["help"]) == (503, "update RTron on the robot")
    guard.close()
    wait_for(lambda: answer(digest)[0] == 404, what="the end of the connection")
    assert client.get(REQUESTS, headers=ann).json() == {"requests": None, "permitted": False}

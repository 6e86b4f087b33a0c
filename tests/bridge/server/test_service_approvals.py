"""What persons at the service say to a bridge: it decides, by name or role, digest and time."""

import json
import os
import socket
import threading
from contextlib import suppress
from dataclasses import replace

import pytest
from approving_bridge import GOAL, ApprovingBridge

from rtron.bridge.protocol.approvals import HOLDS_FOR, MAX_SHOWN, WAITS_FOR, Approvals
from rtron.bridge.rights.document import Approvers
from rtron.bridge.server.approval_commands import ApprovalCommands, ServiceApprovals
from rtron.errors import WireError
from rtron.guard.core.control_socket import ControlSocket
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.link.bridge_requests import LIST_REQUEST, bridge_link_path
from rtron.vocabulary import SECOND
from rtron.wire.common.link_protocol import ApprovalCommand, encode_to_guard

WALL = 1_790_000_000 * SECOND
LONGEST = 'x"\\' * 680
"""As JSON as long as a request may be, and twice as long once more."""


class Desk:
    """The requests of a bridge, persons who answer them, and a clock that the test moves."""

    def __init__(self, roles=("end_user",), names=("dora",)):
        self.now = 5 * SECOND
        self.approvals = Approvals()
        approvers = Approvers(roles=roles, names=names)
        self.service = ServiceApprovals(
            self.approvals, approvers, lambda: self.now, lambda: WALL + self.now
        )

    def ask(self, content=GOAL, client="assistant", what="publish /goal"):
        """Let a client try; return why it does not pass."""
        with pytest.raises(WireError) as refused:
            self.approvals.check(client, what, content, self.now)
        return str(refused.value)

    def passes(self, content=GOAL, client="assistant", what="publish /goal"):
        self.approvals.check(client, what, content, self.now)

    def listed(self):
        return self.service.handle("link", LIST_REQUEST)

    def digest(self):
        (request,) = self.listed()["shown"]
        return request["digest"]

    def say(self, digest, do="approve", by="ann", roles=("end_user",), reason="it is free"):
        command = ApprovalCommand(number=7, digest=digest, do=do, by=by, roles=roles, reason=reason)
        answer = self.service.handle("link", json.loads(encode_to_guard(command)))
        return answer["granted"], answer["reason"]


@pytest.fixture
def desk():
    return Desk()


def test_a_person_sees_a_request_word_for_word_and_it_passes_once(desk):
    desk.ask()
    listed = desk.listed()
    (request,) = listed["shown"]
    assert (listed["count"], listed["roles"], listed["names"]) == (1, ("end_user",), ("dora",))
    assert request["content"] == '{"pose":{"position":{"x":1,"y":3}}}'
    assert request["until"] == WALL + desk.now + WAITS_FOR
    assert desk.say(request["digest"]) == (
        True,
        "request 1 of assistant, publish /goal, is approved by ann at the service",
    )
    assert desk.listed()["count"] == 0
    desk.passes()
    assert "request 2 waits" in desk.ask()


def test_what_is_refused_does_not_pass_and_the_client_hears_by_whom(desk):
    desk.ask()
    assert desk.say(desk.digest(), "refuse")[0]
    assert "ann at the service has refused request 1" in desk.ask()


@pytest.mark.parametrize("second", ["approve", "refuse"])
def test_who_answers_twice_changes_nothing(desk, second):
    desk.ask()
    digest = desk.digest()
    assert desk.say(digest)[0]
    until = desk.now + HOLDS_FOR
    desk.now += 30 * SECOND
    granted, reason = desk.say(digest, second, by="dora")
    assert (granted, "does not wait any more" in reason) == (False, True)
    desk.now = until
    assert "request 2 waits" in desk.ask()


def test_a_request_that_is_over_is_not_approved_by_an_old_click(desk):
    desk.ask()
    old = desk.digest()
    desk.now += WAITS_FOR
    assert not desk.say(old)[0]
    desk.ask()
    assert desk.digest() != old
    assert not desk.say(old)[0]
    assert "request 2 waits" in desk.ask()


@pytest.mark.parametrize("other", [{"x": 2}, {"x": 1.0}, {"x": "1"}, {"x": 1, "y": None}])
def test_other_words_are_another_request(desk, other):
    desk.ask({"x": 1})
    assert desk.say(desk.digest())[0]
    assert "request 2 waits" in desk.ask(other)
    desk.passes({"x": 1})


def test_a_request_of_another_client_or_another_life_of_the_bridge_is_another_one(desk):
    desk.ask()
    seen = desk.digest()
    again = Desk()
    again.ask()
    assert again.digest() != seen
    assert not again.say(seen)[0]
    assert "request 1 waits" in again.ask()
    assert desk.say(seen)[0]
    assert "request 2 waits" in desk.ask(client="rogue")


@pytest.mark.parametrize(
    ("by", "roles", "may"),
    [
        ("ann", ("end_user",), True),
        ("ann", ("developer", "end_user"), True),
        ("dora", (), True),
        ("dora", ("developer",), True),
        ("ann", ("developer",), False),
        ("ann", (), False),
        ("Dora", (), False),
        ("dora ", (), False),
        ("end_user", (), False),
        ("ann", ("dora",), False),
        ("", ("",), False),
    ],
)
def test_only_who_is_named_or_has_the_role_answers(desk, by, roles, may):
    desk.ask()
    for do in ("refuse", "approve")[may:]:
        assert desk.say(desk.digest(), do, by=by, roles=roles)[0] is may
    assert len(desk.approvals.waiting(desk.now)) == (not may)


@pytest.mark.parametrize("roles", [(), ("admin",), ("end_user", "developer")])
def test_rights_that_name_nobody_let_nobody(roles):
    desk = Desk(roles=(), names=())
    desk.ask()
    assert desk.say(desk.digest(), roles=roles) == (
        False,
        "the rights of the bridge let nobody with this name or role answer",
    )


@pytest.mark.parametrize("reason", ["", "  ", "\u200b\u2800"])
def test_nothing_is_answered_without_a_reason_that_can_be_seen(desk, reason):
    desk.ask()
    assert desk.say(desk.digest(), reason=reason) == (False, "to approve a request needs a reason")


@pytest.mark.parametrize(
    "request_",
    [
        {},
        {"requests": "all"},
        {"approval": "approve", "number": 1, "reason": "free"},
        {"type": "approval_command", "number": 1, "digest": "x", "do": "grant", "by": "ann"},
        {"type": "lease_command", "number": 1, "lease": "base", "do": "end", "by": "ann"},
    ],
)
def test_what_the_link_does_not_say_is_refused(desk, request_):
    desk.ask()
    with pytest.raises(WireError):
        desk.service.handle("link", request_)
    assert desk.listed()["count"] == 1


def test_names_and_reasons_cannot_forge_lines(caplog):
    desk = Desk(names=("ann\n\u202ebob",))
    desk.ask()
    granted, reason = desk.say(desk.digest(), by="ann\n\u202ebob", reason="free\nrequest 2 is")
    assert (granted, reason.endswith("approved by ann bob at the service")) == (True, True)
    assert all(record.getMessage().isprintable() for record in caplog.records)


def test_what_a_stranger_writes_is_shown_in_characters_that_turn_nothing_around(desk):
    desk.ask({"data": "\u202e\u200b\x1b[2J\0<b>"})
    (request,) = desk.listed()["shown"]
    assert request["content"] == r'{"data":"\u202e\u200b\u001b[2J\u0000<b>"}'


def test_a_client_with_many_requests_hides_none_of_another_one(desk):
    for number in range(8):
        for client in ("rogue", "rogue_2", "rogue_3"):
            desk.ask(number, client)
    desk.ask(GOAL, "assistant")
    listed = desk.listed()
    assert (listed["count"], len(listed["shown"])) == (25, MAX_SHOWN)
    assert [each["client"] for each in listed["shown"][:4]] == [
        "rogue",
        "rogue_2",
        "rogue_3",
        "assistant",
    ]


def said(path, line):
    """Return what is answered to a line at a socket."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as sock:
        sock.settimeout(60)
        sock.connect(str(path))
        sock.sendall(line + b"\n")
        return sock.makefile("rb").readline()


def test_the_longest_list_of_requests_goes_through_the_socket():
    with ApprovingBridge() as bridge:
        contents = [f"{number}{LONGEST}" for number in range(8)]
        bridge.flood([f"c{number}" for number in range(32)], contents)
        listed = json.loads(said(bridge_link_path("app"), json.dumps(LIST_REQUEST).encode()))
    assert (listed["count"], len(listed["shown"])) == (256, MAX_SHOWN)
    assert all(len(each["content"]) > 3000 for each in listed["shown"])


@pytest.mark.parametrize(("user", "answer"), [(os.getuid(), b"{}\n"), (os.getuid() + 1, b"")])
def test_who_may_speak_in_the_name_of_others_is_one_user_alone(tmp_path, user, answer):
    loop, path = EventLoop(), tmp_path / "own" / "link.sock"
    control = ControlSocket(loop, path, lambda _, request: request, [user])
    control.open()
    thread = threading.Thread(target=loop.run)
    thread.start()
    with suppress(ConnectionError):  # who is not heard is cut off
        assert said(path, b"{}") == answer
        answer = b""
    assert answer == b""
    loop.post(loop.stop)
    thread.join()
    control.close()
    loop.close()


def test_persons_beside_the_robot_speak_for_themselves_alone():
    approvals = Approvals()
    commands = ApprovalCommands(approvals, lambda: 0)
    request = {"approval": "approve", "number": 1, "reason": "free"}
    for more in ({"by": "dora"}, {"roles": ["end_user"]}, {"digest": "0" * 64}):
        with pytest.raises(WireError, match="a request has"):
            commands.handle("ann", request | more)
    command = ApprovalCommand(
        number=1, digest="0" * 64, do="approve", by="dora", roles=(), reason="free"
    )
    with pytest.raises(WireError, match="a request has"):
        commands.handle("ann", json.loads(encode_to_guard(replace(command, number=2))))

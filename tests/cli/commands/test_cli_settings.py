"""`rtron settings`, `events` and `upload` against a real service; its guard is the test."""

import json
import os
import subprocess
import sys
from threading import Thread

import pytest
from controller_setup import hello, plan
from harness import free_port, wait_for
from service_app import AccountFactory, open_app, serve_in_thread

from rtron.cli.support.settings_arguments import KEYS, parse_patch
from rtron.errors import InputError
from rtron.service.config import ServiceConfig
from rtron.service.store.events import EventBatch, add_events
from rtron.service.store.robots import find_robot
from rtron.vocabulary import EventKind, GuardEvent, GuardEventLevel
from rtron.wire.common.link_protocol import Applied

WHY = ("--reason", "a test")


@pytest.fixture
def app(database_file):
    with open_app(ServiceConfig(database=database_file)) as app:
        yield app


@pytest.fixture
def service(app):
    return app.state.service


@pytest.fixture
def url(app):
    with serve_in_thread(app) as port:
        yield f"http://127.0.0.1:{port}"


@pytest.fixture
def tokens(service, tmp_path):
    """Return a file with a token for these scopes."""

    people = AccountFactory(service)

    def token(*scopes):
        header = people.token_headers("me", *scopes)["Authorization"]
        path = tmp_path / f"{'-'.join(scopes)}.token"
        path.write_text(header.removeprefix("Bearer ") + "\n")
        return path

    return token


@pytest.fixture
def call(rtron, url, tokens, service):
    """Run a command as somebody with a role; robot r2 has said hello."""
    service.controller.handle_hello("r2", hello(plan()))

    def run(*words, role="developer"):
        return rtron(*words, "--service", url, "--token-file", tokens(role))

    return run


def test_get_shows_what_is_in_force(call):
    ran = call("settings", "get", role="read")
    assert (ran.code, ran.err) == (0, "")
    assert "revision 0: sent; the guard has not answered yet, by rtron" in ran.out
    assert "  drive    GRCN         Preemption" in ran.out


def test_get_one_node_in_full(call):
    call("settings", "set", "drive", "flow1.priority=7", "release_after=0.2", *WHY)
    out = call("settings", "get", "drive").out
    assert "flow1.priority  7           plan: 2" in out
    assert "release_after   0.2 s       plan: 0.5 s" in out
    assert "You may: select_policy, set_block, set_durations, set_priority, set_timeout" in out
    assert "You may: read only" in call("settings", "get", "drive", role="end_user").out


def test_get_as_json(call):
    document = json.loads(call("settings", "get", "--format", "json").out)
    assert [node["id"] for node in document["nodes"]] == ["drive", "speed", "mission", "eyes"]
    one = json.loads(call("settings", "get", "mission", "--format", "json").out)
    assert one["node"]["mandatory"] == ["quiet"]


def test_set_changes_all_at_once(call, service):
    words = ["policy=Priority_Queue", "flow1.timeout=200ms", "flow2.block=true"]
    ran = call("settings", "set", "drive", *words, *WHY)
    assert (ran.code, ran.out) == (0, "revision 1: sent; the guard has not answered yet\n")
    sent = service.controller.handle_hello("r2", hello(plan())).nodes["drive"]
    assert sent.policy == "Priority_Queue"
    assert sent.flows["flow1"].timeout == 200_000_000
    assert sent.flows["flow2"].block is True


def test_set_takes_back(call):
    call("settings", "set", "drive", "policy=Block", "flow1.priority=9", *WHY)
    call("settings", "set", "drive", "policy=plan", "flow1.priority=plan", *WHY)
    document = json.loads(call("settings", "get", "--format", "json").out)
    assert (document["settings"]["revision"], document["settings"]["settings"]["nodes"]) == (2, {})


@pytest.mark.parametrize(
    ("words", "role", "told", "help"),
    [
        (["drive", "policy=Safe"], "developer", "Safe is not for a GRCN", ""),
        (
            ["drive", "polcy=Block"],
            "developer",
            "no setting is called 'polcy'",
            "did you mean policy?",
        ),
        (["drive", "policy=Blok"], "developer", "unknown word 'Blok'", "did you mean Block"),
        (
            ["drive", "flow9.block=true"],
            "developer",
            "no flow is called 'flow9'",
            "did you mean flow",
        ),
        (["drive", "policy"], "developer", "what is 'policy'?", "KEY=VALUE"),
        (["drive", "flow1.block=maybe"], "developer", "give true or false", "the plan's value"),
        (["drve", "policy=Block"], "developer", "no such coordination node", "there are: drive"),
        (
            ["drive", "policy=Block"],
            "end_user",
            "end_user may not select_policy at drive",
            "developer",
        ),
        (["mission", "quiet.selected=false"], "end_user", "it cannot be deselected", "the plan"),
        (["drive", "policy=Block", "--robot", "r9"], "developer", "no such robot", ""),
    ],
)
def test_what_is_refused_has_help(call, service, words, role, told, help):
    ran = call("settings", "set", *words, *WHY, role=role)
    assert (ran.code, ran.out) == (2, "")
    assert told in ran.err
    assert help in ran.err
    assert service.controller.handle_hello("r2", hello(plan())).revision == 0


def test_a_change_needs_a_reason(call, service):
    without = call("settings", "set", "drive", "policy=Block")
    assert (without.code, "--reason" in without.err) == (2, True)
    unseen = call("settings", "set", "drive", "policy=Block", "--reason", "\u200b\u200b\u200b")
    assert (unseen.code, unseen.out) == (2, "")
    assert "a change of settings needs a reason" in unseen.err
    assert service.controller.handle_hello("r2", hello(plan())).revision == 0


def answering(service, revision, error=""):
    """Answer as the guard would, once the revision is there."""

    def answer():
        wait_for(lambda: service.controller.handle_hello("r2", hello(plan())).revision == revision)
        service.controller.handle_applied("r2", Applied(revision=revision, error=error))

    return Thread(target=answer)


@pytest.mark.parametrize(
    ("error", "code", "told"),
    [("", 0, "revision 1: active\n"), ("no", 1, "revision 1: REJECTED by the guard: no\n")],
)
def test_set_waits_for_the_guard(call, service, error, code, told):
    guard = answering(service, 1, error)
    guard.start()
    ran = call("settings", "set", "drive", "policy=Block", "--wait", "--timeout", "30", *WHY)
    guard.join()
    assert (ran.code, ran.out) == (code, told)


def test_set_does_not_wait_for_ever(call):
    ran = call("settings", "set", "drive", "policy=Block", "--wait", "--timeout", "0.2", *WHY)
    assert (ran.code, ran.out) == (1, "revision 1: sent; the guard has not answered yet\n")


def test_stop_and_release(call):
    assert call("settings", "stop", "--reason", "fire", role="end_user").code == 0
    assert "EMERGENCY STOP by token:me" in call("settings", "get").out
    assert ": fire" in call("settings", "get", "drive").out
    refused = call("settings", "release", "--reason", "")
    assert (refused.code, "needs a reason" in refused.err) == (2, True)
    ended = call("settings", "release", "--reason", "all clear").out
    assert ended.startswith("stopped by token:me.0: fire\nrevision 2: sent")
    assert "EMERGENCY" not in call("settings", "get").out


def test_of_several_robots_one_is_named(call, service):
    service.controller.handle_hello("r3", hello(plan()))
    ran = call("settings", "get")
    assert (ran.code, ran.err) == (2, "error: which robot?\nhelp: give --robot: r2, r3\n")
    assert call("settings", "get", "--robot", "r3").out.startswith("r3")


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (None, "No such file"),
        (b"", "holds no token"),
        (b"a b", "holds no token"),
        (b"\xff", "holds no token"),
        (b"x" * 2000, "holds no token"),
        (b"rtron_x", "unknown"),
    ],
)
def test_a_wrong_token(rtron, url, tmp_path, content, told):
    path = tmp_path / "token"
    if content is not None:
        path.write_bytes(content)
    ran = rtron("settings", "get", "--service", url, "--token-file", path)
    assert (ran.code, told in ran.err) == (2, True)
    assert "rtron_x" not in ran.err


def test_a_guards_token_may_not_look(rtron, url, service, tmp_path):
    header = AccountFactory(service).token_headers("g", "guard", robot="r2")["Authorization"]
    path = tmp_path / "token"
    path.write_text(header.removeprefix("Bearer "))
    ran = rtron("settings", "get", "--service", url, "--token-file", path)
    assert (ran.code, "a role" in ran.err) == (2, True)


@pytest.mark.parametrize("service", ["ftp://x", "127.0.0.1:8600", "http://", ""])
def test_no_address_of_a_service(rtron, tmp_path, service):
    ran = rtron("settings", "get", "--service", service, "--token-file", tmp_path / "x")
    assert (ran.code, "is no address of a service" in ran.err) == (2, True)


def test_nobody_there(rtron, tokens):
    url = f"http://127.0.0.1:{free_port()}"
    ran = rtron("settings", "get", "--service", url, "--token-file", tokens("read"))
    assert (ran.code, "does not answer" in ran.err, "rtron serve" in ran.err) == (2, True, True)


def test_a_token_in_clear_is_warned_of(rtron, tokens):
    words = ["--service", "http://robot.invalid:1", "--token-file", tokens("read")]
    assert "others can read the token" in rtron("settings", "get", *words).err


def test_no_token(rtron, url):
    ran = rtron("settings", "get", "--service", url)
    assert (ran.code, "rtron token create" in ran.err) == (2, True)


@pytest.mark.parametrize("command", ["get", "set", "stop", "release"])
def test_each_command_shows_an_example(rtron, command):
    page = rtron("settings", command, "-h")
    assert f"$ rtron settings {command}" in page.out
    assert max(map(len, page.out.splitlines())) <= 80


def test_each_key_can_be_set():
    values = {"priority": "1", "block": "true", "selected": "true"}
    for key in KEYS:
        owner, _, last = key.rpartition(".")
        word = f"{'flow1.' if owner == 'FLOW' else 'own.' if owner else ''}{last}"
        patch = parse_patch([f"{word}={values.get(last, 'x')}"], ["flow1"], has_rules=True)
        assert patch


@pytest.mark.parametrize(
    ("word", "patch"),
    [
        ("own.block=/goal, aflow1,", {"rules": {"own": {"block": ["/goal", "aflow1"]}}}),
        ("own.when=a=b", {"rules": {"own": {"when": "a=b"}}}),
        ("flow1.block=0", {"flows": {"flow1": {"block": False}}}),
        ("flow1.priority=-3", {"flows": {"flow1": {"priority": -3}}}),
        ("policy=plan", {"policy": None}),
        ("policy=", {"policy": ""}),
    ],
)
def test_words_are_read(word, patch):
    assert parse_patch([word], ["flow1"], has_rules=True) == patch


@pytest.mark.parametrize("word", ["flow1.priority=1.5", "flow1.priority=", "flow1.when=x", "=x"])
def test_words_are_refused(word):
    with pytest.raises(InputError):
        parse_patch([word], ["flow1"], has_rules=True)


# Events.


def happen(service, *reasons, level=GuardEventLevel.WARNING, robot="r2", start=1):
    with service.database.session() as session:
        id = find_robot(session, robot)[0].id
        events = [
            GuardEvent(
                run="r1",
                number=number,
                at=1_700_000_000_000_000_000 + number,
                kind=EventKind.ALARM,
                level=level,
                node="drive",
                topic="/cmd_vel",
                publisher="/evil",
                reason=reason,
            )
            for number, reason in enumerate(reasons, start)
        ]
        added = add_events(session, service.clock(), [EventBatch(id, robot, events)])
    for each in added:
        event = each.view().model_dump(mode="json")
        service.hub.broadcast({"type": "event", "event": event})


def test_events_oldest_first(call, service):
    happen(service, "one", "two\x1b[2J", "three")
    ran = call("events", "-n", "2", role="read")
    two, three = ran.out.splitlines()
    assert two.endswith("! r2 alarm drive /cmd_vel by /evil: two\\x1b[2J")
    assert three.endswith(": three")


@pytest.mark.parametrize(
    ("words", "number"),
    [
        (["--level", "error"], 0),
        (["--level", "warning"], 2),
        (["--robot", "r3"], 0),
        (["--node", "drive", "--kind", "alarm"], 2),
        (["--kind", "stop"], 0),
        (["-n", "0"], 0),
    ],
)
def test_events_that_fit(call, service, words, number):
    happen(service, "one", "two")
    lines = call("events", "--format", "json", *words).out.splitlines()
    assert len([json.loads(line)["reason"] for line in lines]) == number


def test_events_are_followed_each_once(url, tokens, service, tmp_path):
    """Events of before, of meanwhile and live come once each; a closed pipe ends it."""
    service.controller.handle_hello("r2", hello(plan()))
    happen(service, "first")
    words = ["events", "-f", "--format", "json", "--level", "warning"]
    where = ["--service", url, "--token-file", str(tokens("read"))]
    command = [sys.executable, "-m", "rtron", *words, *where]
    environment = {"PATH": os.environ["PATH"], "LANG": "C.UTF-8"}
    with subprocess.Popen(command, stdout=subprocess.PIPE, env=environment) as process:
        try:
            assert reason(process) == "first"
            wait_for(lambda: service.hub.has_listeners)
            happen(service, "quiet", level=GuardEventLevel.INFO, start=2)
            happen(service, "second", "third", start=3)
            assert [reason(process), reason(process)] == ["second", "third"]
        finally:
            process.kill()


def reason(process):
    return json.loads(process.stdout.readline())["reason"]


# Graphs.

GRAPH = {
    "schema": "rtron.graph/1",
    "app": "small",
    "endpoints": [
        {"node": node, "direction": "publish", "topic": "/cmd_vel", "type": "geometry_msgs/Twist"}
        for node in ("/teleop", "/planner")
    ]
    + [{"node": "/base", "direction": "subscribe", "topic": "/cmd_vel"}],
}


def test_upload_gives_the_console_a_graph(call, tmp_path):
    path = tmp_path / "graph.json"
    path.write_text(json.dumps(GRAPH))
    assert call("upload-graph", path).out == "r2 has the graph; 2 risks: 1 GR-ST, 1 MSR\n"
    assert "may not do that" in call("upload-graph", path, role="end_user").err
    path.write_text('{"schema": "rtron.graph/1", "nodse": []}')
    ran = call("upload-graph", path)
    assert (ran.code, "did you mean `nodes`?" in ran.err) == (2, True)

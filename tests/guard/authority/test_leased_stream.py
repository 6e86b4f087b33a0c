"""A base under a lease, whole messages in memory: who asks, who moves it, and who is told what."""

import logging
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from leased_base import AGENT, NAV, PLAN, STRANGER, TELEOP, TTL, TWIST, LeasedBase
from velocity_messages import twist

from rtron.errors import WireError
from rtron.guard.authority.lease_topics import MAX_REQUEST, MAX_REQUESTS, REQUESTS
from rtron.guard.core.report_messages import STRING, read_string, string_message
from rtron.guard.link.event_recorder import EventCounter, EventRecorder
from rtron.guard.link.host_events import HostEvents
from rtron.guard.rehearsal import _StreamCopy
from rtron.guard.replay.player import RecordingPlayer
from rtron.guard.replay.recorded_streams import RecordedStream
from rtron.guard.settings.applier import SettingsApplier
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import (
    SECOND,
    Decision,
    EventKind,
    FlowSettings,
    NodeSettings,
    PolicyName,
    Settings,
    lease_topic,
    list_topic_access,
)


@pytest.fixture
def base():
    return LeasedBase()


def commanded(base, who=NAV):
    """Let a node have the lease and drive."""
    base.ask(who, "acquire to drive")
    assert base.stand(who)
    assert base.drive(who, 0.5)


def test_without_a_lease_nobody_moves_the_base(base):
    assert not base.stand(NAV)
    assert not base.drive(TELEOP, 0.5)
    assert base.driver == []
    assert base.reason("teleop") == "nobody holds base"
    assert base.active_text() == "nobody holds base"
    assert base.status() == {
        "lease": "base",
        "ttl": 2.0,
        "holder": "",
        "reason": "nobody holds base",
    }


def test_who_has_asked_for_it_moves_the_base_after_a_neutral_command(base):
    answer = base.ask(NAV, "acquire  a goal\nhas come")
    assert (answer["to"], answer["request"], answer["granted"]) == (NAV, "acquire", True)
    assert not base.drive(NAV, 0.5)
    assert base.reason("nav") == "/nav (autonomy) must send a neutral command first"
    assert base.stand(NAV)
    assert base.drive(NAV, 0.5)
    assert not base.drive(TELEOP, 0.1)
    status = base.status()
    assert (status["holder"], status["rank"]) == (NAV, "autonomy")
    assert status["reason"] == "acquired: a goal has come"


def test_active_tells_who_holds_what_since_when_and_why(base):
    base.ask(NAV, "acquire a goal")
    text = base.active_text()
    assert text.startswith("/nav (autonomy) holds base since 20")
    assert text.endswith(", acquired: a goal")


def test_each_change_of_hands_is_told(base):
    before = len(base.active)
    base.ask(NAV, "acquire")
    base.ask(NAV, "renew")
    assert len(base.active) == before + 1
    base.ask(TELEOP, "take_over")
    assert len(base.active) == before + 2
    base.pass_time(TTL)
    assert base.active_text() == "nobody holds base; /teleop (operator_on_site) held it last"


def test_a_stream_tells_of_a_holder_that_commands_others_of_its_group():
    base_node, arm = PLAN.grcn
    fewer = replace(base_node, flows=base_node.flows[:2])
    base = LeasedBase(replace(PLAN, grcn=(fewer, arm)))
    base.ask(AGENT, "acquire a demo")
    assert base.active_text().startswith("/agent (agent) holds base since 20")
    assert not base.stand(NAV)
    assert base.stand(AGENT, "/arm_vel")


def test_each_stream_of_the_group_needs_a_neutral_command_of_its_own(base):
    commanded(base)
    assert not base.drive(NAV, 0.5, "/arm_vel")
    assert base.stand(NAV, "/arm_vel")
    assert base.drive(NAV, 0.5, "/arm_vel")


def test_the_service_hears_who_holds_it(base, tmp_path):
    events = []
    counter = EventCounter(tmp_path, "run")
    recorder = EventRecorder(counter, "run", events.append, lambda: True, lambda: 0)
    host = HostEvents(base.host, recorder.record)
    host.start()
    base.ask(NAV, "acquire a goal")
    owners = [each for each in events if each.kind is EventKind.OWNER]
    (owner,) = (each for each in owners if each.topic == "/cmd_vel")
    assert (owner.flow, owner.publisher) == ("nav", NAV)
    assert owner.reason.endswith(", acquired: a goal")
    state = host.stream_monitors["enforce /cmd_vel"].state(base.transport.now())
    assert state.lease == owner.reason == base.active_text()


@pytest.mark.parametrize("ending", ["expires", "release", "take_over", "end"])
def test_a_lost_lease_stops_the_base_at_once(base, ending):
    commanded(base)
    if ending == "expires":
        base.pass_time(TTL - SECOND // 4)
        assert base.drive(NAV, 0.5)
        base.pass_time(SECOND // 4)
    elif ending == "release":
        base.ask(NAV, "release")
    elif ending == "take_over":
        base.ask(TELEOP, "take_over a person is near")
    else:
        base.commands.handle("ann", {"lease": "base", "do": "end", "to": "", "reason": "test"})
    assert base.active_text().startswith("stopping: ")
    before = len(base.driver)
    base.pass_time(SECOND // 5)
    ramp = base.speeds()[before - 1 :]
    assert ramp == sorted(ramp, reverse=True)
    assert ramp[-1] == 0.0
    assert not base.drive(NAV, 0.5)


def test_each_end_of_a_lease_is_noticed(base):
    for _ in range(3):
        commanded(base)
        base.pass_time(TTL - SECOND // 4)
        assert base.drive(NAV, 0.5)
        base.pass_time(SECOND // 4)
        assert base.active_text().startswith("stopping: nobody holds base")
        assert base.status()["holder"] == ""
        base.pass_time(SECOND)


def test_a_renewed_lease_holds(base):
    commanded(base)
    for _ in range(5):
        base.pass_time(TTL // 2)
        base.ask(NAV, "renew")
        assert base.stand(NAV)
        assert base.drive(NAV, 0.4)
    assert [each["request"] for each in base.answers()] == ["acquire"], "a renewal is not answered"


def test_a_silent_holder_stops_the_base_and_keeps_the_lease(base):
    commanded(base)
    base.pass_time(SECOND)
    assert base.speeds()[-1] == 0.0
    assert base.status()["holder"] == NAV


def test_the_log_says_each_change_of_hands(base, caplog):
    with caplog.at_level(logging.WARNING):
        base.ask(NAV, "acquire a goal")
        base.ask(NAV, "renew")
        base.ask(AGENT, "take_over please")
        base.pass_time(TTL)
    lines = [each.getMessage() for each in caplog.records if "lease" in each.getMessage()]
    assert [line.partition(" for ")[0] for line in lines] == [
        "lease base: acquire by /nav: base is granted to /nav (autonomy)",
        "lease base: take_over by /agent is refused: /nav (autonomy) holds base",
        "lease base: nobody holds base; /nav (autonomy) held it last, it was not renewed",
    ]


def test_it_is_handed_over_with_consent(base):
    commanded(base, TELEOP)
    assert not base.ask(AGENT, "accept")["granted"]
    assert base.ask(TELEOP, f"offer {AGENT}")["granted"]
    assert base.drive(TELEOP, 0.5)
    assert base.ask(AGENT, "accept")["granted"]
    assert not base.drive(TELEOP, 0.5)
    assert not base.drive(AGENT, 0.5)
    assert base.stand(AGENT)
    assert base.drive(AGENT, 0.5)


@pytest.mark.parametrize("word", REQUESTS)
def test_a_stranger_is_told_once_that_it_may_ask_for_nothing(base, word, caplog):
    commanded(base)
    before = len(base.answers())
    base.ask(STRANGER, f"{word} {STRANGER}")
    base.ask(STRANGER, f"{word} {STRANGER}")
    assert base.answers()[before:] == [
        {
            "to": STRANGER,
            "request": "",
            "granted": False,
            "reason": "it is no commander of base: the plan does not name it",
        }
    ]
    assert base.status()["holder"] == NAV
    assert base.drive(NAV, 0.5)
    assert "/stranger may ask for nothing" in caplog.text


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ({"verified": False}, "another node owns its name, or nobody knows whose it is"),
        ({"latching": True}, "its requests are latched: an old one would come again"),
    ],
)
def test_a_name_that_is_only_claimed_or_an_old_request_gets_nothing(base, options, reason):
    answer = base.ask(TELEOP, "acquire", **options)
    assert (answer["granted"], answer["reason"]) == (False, reason)
    assert base.status()["holder"] == ""


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "nothing is called ''"),
        ("aquire", "nothing is called 'aquire': did you mean acquire?"),
        ("ACQUIRE", "nothing is called 'ACQUIRE'"),
        ("x" * (MAX_REQUEST + 1), "no request: a text of 1025 bytes is too long: 1024 at most"),
        (b"", "no request: a message of 0 bytes has not even its first 4"),
        (b"\4\0\0\0", "no request: 4 bytes are announced, 0 are there"),
        (b"\0\0\0\0", "no request: a text has a length"),
        (b"\4\0\0\0\xff\xff\xff\xff", "no request: a text of 4294967295 bytes is too long"),
        (b"\4\0\0\0\1\0\0\0", "no request: the message ends 1 bytes before its fields do"),
    ],
)
def test_what_is_no_request_is_refused_with_a_reason(base, text, reason):
    answer = base.ask(NAV, text)
    assert not answer["granted"]
    assert answer["reason"].startswith(reason)
    assert base.status()["holder"] == ""


def test_a_flood_of_requests_is_told_once_a_second_and_not_read(base):
    for _ in range(MAX_REQUESTS):
        assert not base.ask(AGENT, "release flood")["granted"]
    for _ in range(500):
        base.ask(AGENT, "acquire flood")
    told = [each["reason"] for each in base.answers()[MAX_REQUESTS:]]
    assert told == ["more than 10 requests a second: the others are not read"]
    assert base.status()["holder"] == ""
    assert base.ask(TELEOP, "acquire")["granted"]
    base.pass_time(SECOND)
    assert not base.ask(AGENT, "acquire")["granted"]
    assert "/teleop (operator_on_site) holds base" in base.answers()[-1]["reason"]


def test_a_word_that_steers_a_terminal_is_escaped(base):
    answer = base.ask(NAV, "\x1b[2Jacquire")
    assert not answer["granted"]
    assert "\x1b" not in answer["reason"] + answer["request"]


@pytest.mark.parametrize("encoding", Encoding)
@pytest.mark.parametrize("text", ["", "a", "acquire", "grüße"])
def test_texts_are_read_as_they_are_written(encoding, text):
    assert read_string(encoding, string_message(encoding, text), 100) == text


def test_a_person_beside_the_robot_gives_and_ends_it(base):
    commanded(base, TELEOP)
    given = {"lease": "base", "do": "give", "to": AGENT, "reason": "a demo"}
    assert "given by ann: a demo" in base.commands.handle("ann", given)["answer"]
    assert not base.drive(TELEOP, 0.5)
    assert base.stand(AGENT)
    ended = {"lease": "base", "do": "end", "to": "", "reason": "it is over"}
    answer = base.commands.handle("ann", ended)["answer"]
    assert answer == "base is taken from /agent (agent) by ann: it is over"
    listed = base.commands.handle("ann", {"lease": "", "do": "list", "to": "", "reason": ""})
    assert [each["holder"] for each in listed["leases"]] == [""]
    with pytest.raises(WireError, match="nobody holds base"):
        base.commands.handle("ann", ended)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"do": "steal"}, "what to do with a lease is list, give or end"),
        ({"reason": " "}, "to give a lease needs a reason"),
        ({"reason": 3}, "a reason is a text"),
        ({"to": 3}, "a request has do, lease, reason, to"),
        ({"more": 3}, "a request has do, lease, reason, to"),
        ({"lease": "bse"}, "no lease is called 'bse': did you mean base?"),
        ({"lease": ["base"]}, "no lease is called"),
        ({"to": STRANGER}, "/stranger is no commander of base"),
    ],
)
def test_a_wrong_request_of_a_person_changes_nothing(base, changes, message):
    commanded(base, TELEOP)
    request = {"lease": "base", "do": "give", "to": AGENT, "reason": "a demo"} | changes
    with pytest.raises(WireError, match=message):
        base.commands.handle("ann", request)
    assert base.drive(TELEOP, 0.5)


def test_after_any_stop_of_the_guard_the_holder_is_neutral_first(base):
    commanded(base)
    stream = base.host.streams[0]
    stream.release("nobody")
    assert base.drive(NAV, 0.5)
    stream.brake("audit", "an intruder is there")
    base.pass_time(SECOND)
    stream.release("audit")
    assert not base.drive(NAV, 0.5)
    assert base.reason("nav") == "/nav (autonomy) must send a neutral command first"
    assert base.stand(NAV)
    assert base.drive(NAV, 0.5)


def test_a_holder_whose_publisher_is_gone_begins_neutral(base):
    commanded(base)
    base.leave(NAV)
    base.pass_time(SECOND)
    assert base.speeds()[-1] == 0.0
    assert not base.drive(NAV, 0.5)
    assert base.stand(NAV)


def test_only_commanders_may_publish_where_a_lease_is_asked_for():
    topic = lease_topic("base", "request")
    (access,) = [each for each in list_topic_access(PLAN) if each.topic == topic]
    assert access.stream_topic == "/cmd_vel"
    assert access.publishers == (TELEOP, NAV, AGENT)
    assert not access.may_publish(STRANGER)
    assert access.may_subscribe("/rtron_guard")
    assert not access.may_subscribe(STRANGER)


def changed(base, **flow):
    """Put settings in force that change the flow `teleop`."""
    applier = SettingsApplier(base.plan, base.host, base.transport)
    nodes = {"grcn_cmd_vel": NodeSettings(flows={"teleop": FlowSettings(**flow)})}
    applier.apply(Settings(revision=2, nodes=nodes), 0)


def test_new_settings_leave_the_holder_in_command(base):
    commanded(base)
    changed(base, block=True)
    assert base.drive(NAV, 0.25)
    assert not base.stand(TELEOP)


def test_a_holder_that_is_blocked_stops(base):
    commanded(base, TELEOP)
    changed(base, block=True)
    base.pass_time(SECOND)
    assert base.speeds()[-1] == 0.0
    assert not base.stand(TELEOP)


def test_a_guard_that_changes_to_another_policy_asks_for_no_lease(base):
    applier = SettingsApplier(base.plan, base.host, base.transport)
    nodes = {"grcn_cmd_vel": NodeSettings(policy=PolicyName.BLOCK)}
    applier.apply(Settings(revision=2, nodes=nodes), 0)
    assert base.drive(NAV, 0.5)
    applier.apply(Settings(revision=3), 0)
    assert not base.drive(NAV, 0.5)
    base.ask(NAV, "acquire")
    assert base.stand(NAV)


def test_the_rehearsal_of_a_stream_passes_what_its_holder_sends(base):
    commanded(base)
    stream = base.host.streams[0]
    copy = _StreamCopy(stream, base.host.observations, base.transport)
    assert copy.receive("nav", twist(0.5)).decision is Decision.PASS
    assert copy.receive("teleop", twist(0.5)).decision is Decision.DROP
    base.ask(NAV, "release")
    assert copy.receive("nav", twist(0.5)).decision is Decision.DROP


def test_a_replay_takes_the_requests_of_the_recording():
    request = RecordedStream(lease_topic("base", "request"), STRING.type, STRING.md5sum, "", NAV)
    drive = RecordedStream("/cmd_vel", TWIST.type, TWIST.md5sum, TWIST.definition, NAV)
    acquire = string_message(Encoding.ROS1, "acquire")
    sent = [(request, acquire), (drive, twist(0.5)), (drive, twist(0.0)), (drive, twist(0.5))]
    for messages, passed in ((sent, 2), (sent[1:], 0)):
        recording = [(SECOND + at, *each) for at, each in enumerate(messages)]
        report = RecordingPlayer(PLAN).play(recording, lambda count: None)
        (stream,) = (each for each in report.streams if each.topic == "/cmd_vel")
        assert [each.passed for each in stream.flows if each.flow == "nav"] == [passed]


words = st.sampled_from(["", "acquire", "renew", "release", "offer", "accept", "take_over", "x"])
texts = st.tuples(words, st.sampled_from(["", TELEOP, NAV, "\0", "\u202e", "x" * 300])).map(
    " ".join
)
requests = texts.map(lambda text: string_message(Encoding.ROS1, text)) | st.binary(max_size=80)


@given(st.lists(st.tuples(st.sampled_from([TELEOP, NAV, AGENT, STRANGER]), requests), max_size=20))
def test_whatever_is_said_each_request_has_an_answer_and_one_holder_at_most(said):
    base = LeasedBase()
    for who, message in said:
        before = len(base.answers())
        base.ask(who, message)
        base.pass_time(SECOND // MAX_REQUESTS)
        new = base.answers()[before:]
        is_answered = who != STRANGER and b"renew" not in message
        assert len(new) == 1 or (len(new) == 0 and not is_answered)
        for answer in new:
            assert answer["to"] == who
            assert answer["reason"]
            assert all(each.isprintable() for each in (answer["request"], answer["reason"]))
        assert base.status()["holder"] in ("", TELEOP, NAV, AGENT)

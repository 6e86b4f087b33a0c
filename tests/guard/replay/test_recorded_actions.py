"""Recordings of actions of ROS 2: goals from service introspection, ends from the status."""

import pytest
from plans import grcn, plan_of
from service_events import (
    ACTION,
    HEARD,
    RECEIVED,
    SENT,
    cancel_request_event,
    goal_request_event,
    goal_response_event,
)

from rtron.guard.replay.player import RecordingPlayer
from rtron.guard.replay.recorded_streams import RecordedStream
from rtron.messages.ros2.actions import CANCELED, EXECUTING, SUCCEEDED, GoalStatus, status_array
from rtron.vocabulary import (
    MSRCN,
    SECOND,
    Flow,
    GuardedTopic,
    MessageDefinition,
    MissionRule,
    Mode,
    PolicyName,
    StreamKind,
)

TYPE = "my_msgs/action/Dig"
OWN = (MessageDefinition(type=TYPE, definition=ACTION),)
QUEUE = {"type": TYPE, "kind": StreamKind.ACTION, "policy": PolicyName.FIFO_QUEUE}
SEND = RecordedStream("/dig/_action/send_goal/_service_event", f"{TYPE}_SendGoal_Event")
CANCEL = RecordedStream(
    "/dig/_action/cancel_goal/_service_event", "action_msgs/srv/CancelGoal_Event"
)
STATUS = RecordedStream("/dig/_action/status", "action_msgs/msg/GoalStatusArray")
FEEDBACK = RecordedStream("/dig/_action/feedback", f"{TYPE}_FeedbackMessage")
RESULT = RecordedStream("/dig/_action/get_result/_service_event", f"{TYPE}_GetResult_Event")
POSE = RecordedStream("/goal_pose", "geometry_msgs/msg/PoseStamped")


def plan(*publishers, **more):
    made = grcn("/dig", publishers or ["/one"], ["/server"], max_age=60 * SECOND, **QUEUE | more)
    return plan_of(made, ros=2, messages=OWN)


def told(*statuses):
    return status_array(GoalStatus(bytes([id] * 16), 5, status) for id, status in statuses)


def play(wanted, *rows):
    """Play (recorded, message) one second after the other."""
    messages = ((n * SECOND, *row) for n, row in enumerate(rows))
    return RecordingPlayer(wanted).play(messages, lambda count: None)


def counts(fake_study, flow="flow1", stream=0):
    count = next(each for each in fake_study.streams[stream].flows if each.flow == flow)
    return count.passed, count.held, count.dropped


def test_goals_take_turns_that_the_recorded_status_ends():
    rows = [
        (SEND, goal_request_event(1)),
        (SEND, goal_response_event(1)),
        (STATUS, told((1, EXECUTING))),
        (SEND, goal_request_event(2)),
        (FEEDBACK, b"\0\1\0\0" + bytes(40)),
        (RESULT, b"whatever"),
        (STATUS, told((1, SUCCEEDED), (2, EXECUTING))),
    ]
    found = play(plan(), *rows)
    assert counts(found) == (2, 1, 0)
    assert found.notes == ("/dig: whose its goals are is not recorded: taken for /one",)
    assert [(each.at // SECOND, each.decision) for each in found.changes] == [
        (0, "pass"),
        (3, "hold"),
        (6, "pass"),
    ]


def test_what_client_and_server_tell_of_one_request_counts_once():
    rows = [
        (SEND, goal_request_event(1, kind=SENT)),
        (SEND, goal_request_event(1, kind=RECEIVED)),
        (SEND, goal_response_event(1, kind=HEARD)),
        (SEND, goal_response_event(1)),
        (CANCEL, cancel_request_event(1, kind=SENT)),
        (CANCEL, cancel_request_event(1)),
    ]
    assert counts(play(plan(), *rows)) == (1, 0, 0)


def test_a_goal_that_the_server_rejected_ends_its_turn():
    rows = [
        (SEND, goal_request_event(1)),
        (SEND, goal_response_event(1, accepted=False)),
        (SEND, goal_request_event(2)),
    ]
    assert counts(play(plan(), *rows)) == (2, 0, 0)


def test_a_goal_that_waited_is_over_at_once_if_it_was_by_then_in_the_recording():
    rows = [
        (SEND, goal_request_event(1)),
        (SEND, goal_response_event(1)),
        (SEND, goal_request_event(2)),
        (SEND, goal_response_event(2)),
        (SEND, goal_request_event(3)),
        (STATUS, told((1, EXECUTING), (2, SUCCEEDED))),
        *[(STATUS, told((1, EXECUTING), (2, SUCCEEDED), (3, EXECUTING)))] * 5,
        (STATUS, told((1, SUCCEEDED), (2, SUCCEEDED), (3, EXECUTING))),
        (FEEDBACK, b""),
    ]
    assert counts(play(plan(), *rows)) == (3, 2, 0)


def test_a_cancel_takes_back_a_goal_that_waits():
    rows = [
        (SEND, goal_request_event(1)),
        (SEND, goal_request_event(2)),
        (CANCEL, cancel_request_event(2)),
        (STATUS, told((1, SUCCEEDED), (2, CANCELED))),
        (FEEDBACK, b""),
    ]
    assert counts(play(plan(), *rows)) == (1, 1, 1)


def test_a_goal_that_is_refused_takes_no_turn_although_it_ran_in_the_recording():
    (act,) = plan().grcn
    wanted = plan_of(act, ros=2, messages=OWN, msrcn=_shallow())
    rows = [
        (SEND, goal_request_event(1, 1.5)),
        *[(STATUS, told((1, EXECUTING)))] * 20,
        (SEND, goal_request_event(2, 0.5)),
    ]
    assert counts(play(wanted, *rows)) == (1, 0, 1)


def test_a_rule_looks_into_the_goals():
    wanted = plan_of(ros=2, messages=OWN, msrcn=_shallow())
    rows = [(SEND, goal_request_event(id, depth)) for id, depth in ((1, 0.5), (2, 1.5), (3, 1.0))]
    found = play(wanted, *rows)
    assert counts(found, "a1") == (2, 0, 1)
    assert found.changes[1].reason == "rule deep: while true"


def _shallow():
    aflow = Flow(name="a1", publisher="/one")
    return MSRCN(
        id="msrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.BLOCK,
        aflows=(GuardedTopic(topic="/dig", type=TYPE, flows=(aflow,), successors=("/server",)),),
        rules=(MissionRule(name="deep", action="action.depth > 1.0", block=("/dig",)),),
    )


def test_goals_of_several_clients_are_nobody_s():
    found = play(plan("/one", "/two"), (SEND, goal_request_event(1)))
    assert counts(found, "unapproved") == (0, 0, 1)
    assert found.notes[0] == (
        "/dig: whose its goals are is not recorded: nobody that the plan knows"
    )


def test_in_a_recording_of_the_guarded_app_the_private_names_tell_whose_a_goal_is():
    private = RecordedStream("/rtron/dig/flow2/_action/send_goal/_service_event", SEND.type)
    out = RecordedStream("/rtron/dig/out/_action/send_goal/_service_event", SEND.type)
    rows = [
        (private, goal_request_event(1, kind=SENT)),
        (out, goal_request_event(1, asker=2)),
        (SEND, b""),
    ]
    found = play(plan("/one", "/two"), *rows)
    assert (counts(found, "flow2"), counts(found, "unapproved")) == ((1, 0, 0), (0, 0, 0))
    assert not [note for note in found.notes if "whose" in note]


def test_without_the_requests_the_report_says_what_to_record():
    found = play(plan(), (STATUS, told((1, EXECUTING))), (FEEDBACK, b""))
    assert counts(found) == (0, 0, 0)
    (note,) = found.notes
    assert note.startswith("/dig: no goals are recorded, they are requests: record /dig/_action/")
    assert "/dig/_action/send_goal/_service_event" in note
    assert "status tells of count as the server's own" in note


def test_goals_that_only_the_status_knows_take_the_turn():
    rows = [
        (STATUS, told((9, EXECUTING))),
        (SEND, goal_request_event(1)),
        (STATUS, told((9, SUCCEEDED))),
        (FEEDBACK, b""),
    ]
    found = play(plan(), *rows)
    assert counts(found) == (1, 1, 0)


def test_metadata_alone_and_what_cannot_be_read_are_counted():
    rows = [
        (SEND, goal_request_event(1, contents=False)),
        (SEND, goal_request_event(2, contents=False)),
        (SEND, goal_request_event(3)[:70]),
        (SEND, b""),
        (CANCEL, b"\0\1\0\0"),
        (STATUS, b"\0\1\0\0\xff\xff\xff\xff"),
        (STATUS, b"\0\7"),
    ]
    found = play(plan(), *rows)
    assert counts(found) == (0, 0, 0)
    assert "/dig: 2 requests are recorded without what they ask: not judged" in found.notes
    assert "/dig: 5 messages cannot be read: not judged" in found.notes


def test_without_a_status_goals_end_when_they_are_overdue():
    found = play(
        plan(max_hold=SECOND // 2), (SEND, goal_request_event(1)), (SEND, goal_request_event(2))
    )
    assert counts(found) == (2, 0, 0)
    assert "/dig: no status is recorded: a goal ends only when it is overdue" in found.notes


def test_an_action_that_is_only_observed_says_so():
    found = play(
        plan(mode=Mode.OBSERVE), (SEND, goal_request_event(1)), (STATUS, told((1, EXECUTING)))
    )
    assert counts(found) == (0, 0, 0)
    assert "/dig: a plan that only observes sees no goals of ROS 2" in found.notes


def test_a_type_that_nobody_defines_is_judged_by_whose_turn_it_is():
    wanted = plan_of(*plan().grcn, ros=2)
    rows = [
        (SEND, goal_request_event(1)),
        (SEND, goal_request_event(2)),
        (STATUS, told((1, SUCCEEDED))),
    ]
    assert counts(play(wanted, *rows, (FEEDBACK, b""))) == (2, 1, 0)


def test_what_a_dry_run_would_measure_of_goals():
    rows = [
        (SEND, goal_request_event(1)),
        (SEND, goal_response_event(1)),
        (STATUS, told((1, EXECUTING))),
        (STATUS, told((1, SUCCEEDED))),
        (FEEDBACK, b""),
    ]
    player = RecordingPlayer(plan(), measured=True)
    player.play(((n * SECOND, *row) for n, row in enumerate(rows)), lambda count: None)
    (stream,) = player.figures().streams
    assert stream.flows[0].messages == 1


@pytest.mark.parametrize("action", [False, True])
def test_a_pose_is_followed_to_the_recorded_goal(action):
    settings = {"type": POSE.type, "kind": StreamKind.ACTION, "policy": PolicyName.FIFO_QUEUE}
    poses = grcn("/goal_pose", ["/rviz"], ["/server"], done="/dig", max_age=60 * SECOND, **settings)
    wanted = plan_of(poses, *(plan().grcn if action else ()), ros=2, messages=OWN)
    rows = [
        (STATUS, told()),
        (POSE, b"\0\1\0\0first"),
        (STATUS, told((1, EXECUTING))),
        (POSE, b"\0\1\0\0second"),
        (POSE, b"\0\1\0\0third"),
        (STATUS, told((1, SUCCEEDED))),
        (FEEDBACK, b""),
    ]
    found = play(wanted, *rows)
    assert counts(found) == (2, 2, 0)


def test_garbage_on_every_topic_is_no_traceback():
    garbage = [b"", b"\0\1", b"\0\1\0\0", b"\0\1\0\0" + b"\xff" * 99, bytes(300)]
    topics = (SEND, CANCEL, STATUS, FEEDBACK, RESULT)
    found = play(plan(), *((topic, each) for topic in topics for each in garbage))
    assert counts(found) == (0, 0, 0)

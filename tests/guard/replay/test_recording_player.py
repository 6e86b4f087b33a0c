"""A recording played through a plan: where its messages arrive, and what becomes of them."""

from dataclasses import replace

import pytest
from app_in_memory import info
from test_mission_stream import AT_RED, LIGHT, MOVING, string
from test_velocity_limits import VELOCITY, plan
from velocity_messages import image, twist

from rtron.guard.replay.player import MOST_CHANGES, RecordingPlayer
from rtron.guard.replay.recorded_streams import RecordedStream
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import MSRCN, SECOND, Flow, Mode, Plan, PolicyName

TWIST, IMAGE, STRING = (
    info(type) for type in ("geometry_msgs/Twist", "sensor_msgs/Image", "std_msgs/String")
)
START = 1_700_000_000 * SECOND


def recorded(topic, publisher, type=TWIST):
    return RecordedStream(topic, type.type, type.md5sum, type.definition, publisher)


NAV = recorded("/cmd_vel", "/nav")


def play(wanted, messages):
    return RecordingPlayer(wanted).play(
        [(START + at, *rest) for at, *rest in messages], lambda count: None
    )


def counts(fake_study, flow, topic="/cmd_vel"):
    stream = next(stream for stream in fake_study.streams if stream.topic == topic)
    count = next(count for count in stream.flows if count.flow == flow)
    return count.passed, count.held, count.dropped, count.modified


LIMITED = plan(PolicyName.CONSTRAIN, VELOCITY, max_vel_limit=0.5)


def test_every_message_of_a_guarded_topic_is_counted_by_what_would_become_of_it():
    rogue = recorded("/cmd_vel", "/rogue")
    steps = [(0, NAV, twist(0.4)), (1, NAV, twist(2.0)), (2, NAV, b"bad"), (3, rogue, twist(0.1))]
    found = play(LIMITED, steps)
    assert counts(found, "vflow1") == (1, 0, 1, 1)
    assert counts(found, "unapproved") == (0, 0, 1, 0)
    assert (found.messages, found.duration) == (4, 3)


def test_the_recording_s_clock_decides_what_is_silent():
    close, far = (
        play(LIMITED, [(0, NAV, twist(0.4)), (gap, NAV, twist(0.4))])
        for gap in (5 * SECOND - 1, 5 * SECOND)
    )
    assert [found.streams[0].stops for found in (close, far)] == [0, 1]


def test_time_that_goes_back_stands_still():
    found = play(LIMITED, [(SECOND, NAV, twist(0.4)), (0, NAV, twist(0.4)), (2, NAV, twist(0.4))])
    assert found.duration == 0
    assert counts(found, "vflow1") == (3, 0, 0, 0)


def test_changes_are_told_once_with_their_time():
    steps = [(n * SECOND, NAV, twist(2.0 if 3 <= n < 6 else 0.1 * n)) for n in range(5)]
    found = play(LIMITED, steps)
    assert [(each.at, each.decision) for each in found.changes] == [
        (0, "pass"),
        (3 * SECOND, "modify"),
    ]
    assert found.changes[1].reason == "limited to 0.5 m/s (max_vel_limit)"


def test_changes_are_bounded_and_the_rest_is_counted():
    steps = [(n, NAV, twist(2.0 * (n % 2))) for n in range(MOST_CHANGES + 10)]
    found = play(LIMITED, steps)
    assert (len(found.changes), found.unseen) == (MOST_CHANGES, 10)


def test_frames_of_a_recording_are_counted_by_the_fps_monitors():
    camera = recorded("/detector/image", "/detector", IMAGE)
    frames = [(n * SECOND // 10, camera, image(n + 1)) for n in range(20)]
    wanted = plan(PolicyName.SAFE, VELOCITY, threshold=0.05)
    found = play(wanted, [*frames, (19 * SECOND // 10, NAV, twist(2.0))])
    assert found.changes[-1].reason == "limited to 0.5 m/s (fps_cam: 10.0 fps x 0.05 m)"


def test_events_of_a_recording_set_bits():
    msrcn = MSRCN(
        id="msrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.BLOCK,
        aflows=(MOVING,),
        eflows=(LIGHT,),
        rules=(AT_RED,),
    )
    lamp = recorded("/light", "/camera", STRING)
    steps = [(0, lamp, string("green")), (1, NAV, twist(1.0)), (2, lamp, string("red"))]
    found = play(Plan(app="t", msrcn=msrcn), [*steps, (3, NAV, twist(1.0))])
    assert counts(found, "aflow1") == (1, 0, 1, 0)


def test_what_the_guard_itself_said_is_not_played_again():
    own = recorded("/cmd_vel", "/rtron/rsrcn")
    found = play(LIMITED, [(0, own, twist(0.4)), (1, NAV, twist(0.4))])
    assert counts(found, "unapproved") == (0, 0, 0, 0)
    assert counts(found, "vflow1") == (1, 0, 0, 0)


def test_a_recording_of_the_guarded_app_is_played_on_its_private_topics():
    private = recorded("/rtron/cmd_vel/vflow1", "/nav")
    assert counts(play(LIMITED, [(0, private, twist(0.4))]), "vflow1") == (1, 0, 0, 0)


def test_an_unknown_publisher_is_the_only_one_that_the_plan_has_or_nobody():
    nameless = recorded("/cmd_vel", "")
    found = play(LIMITED, [(0, nameless, twist(0.4))])
    assert counts(found, "vflow1") == (1, 0, 0, 0)
    assert found.notes == ("/cmd_vel: its publisher is not recorded: taken for /nav",)
    two = replace(VELOCITY, flows=(*VELOCITY.flows, Flow(name="vflow2", publisher="/teleop")))
    found = play(plan(PolicyName.CONSTRAIN, two, max_vel_limit=0.5), [(0, nameless, twist(0.4))])
    assert counts(found, "unapproved") == (0, 0, 1, 0)
    assert "nobody that the plan knows" in found.notes[0]


def test_messages_of_ros_2_are_read_as_cdr():
    wanted = replace(LIMITED, ros=2)
    nameless = RecordedStream("/cmd_vel", "geometry_msgs/msg/Twist")
    message = Encoding.CDR.prefix(48) + twist(2.0)[4:]
    found = play(wanted, [(0, nameless, message), (1, nameless, twist(2.0))])
    assert counts(found, "vflow1") == (0, 0, 1, 1)


def test_a_whole_recording_ends_as_message_by_message():
    steps = [(n * SECOND // 7, NAV, twist(0.1 * (n % 9))) for n in range(200)]
    at_once = play(LIMITED, steps)
    player = RecordingPlayer(LIMITED)
    for at, on, data in steps:
        found = player.play([(START + at, on, data)], lambda count: None)
    assert found.streams == at_once.streams
    assert found.changes == at_once.changes


@pytest.mark.parametrize("count", [0, 1])
def test_an_empty_recording_is_no_error(count):
    found = play(LIMITED, [(0, NAV, twist(0.1))] * count)
    assert found.messages == count


def test_a_long_gap_is_jumped_over():
    found = play(LIMITED, [(0, NAV, twist(0.4)), (10**9 * SECOND, NAV, twist(2.0))])
    assert counts(found, "vflow1") == (1, 0, 0, 1)
    assert found.duration == 10**9 * SECOND
    assert found.notes == ("nothing was recorded for 1000000000 s",)
    assert found.streams[0].stops == 1


def test_a_stop_is_told_with_its_time_and_reason():
    found = play(LIMITED, [(0, NAV, twist(0.4)), (9 * SECOND, NAV, twist(0.4))])
    stop = next(change for change in found.changes if change.decision == "stop")
    assert (stop.at, stop.reason) == (5 * SECOND, "vflow1 has been silent for 5.00 s")

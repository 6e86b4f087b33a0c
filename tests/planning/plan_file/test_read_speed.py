"""RSRCN, fps_monitors and the stop in a plan file: what they take, and every slip with its line."""

import math

import pytest

from rtron.errors import PlanError
from rtron.planning import parse_plan, write_plan
from rtron.vocabulary import (
    RSRCN,
    SECOND,
    Flow,
    FpsMonitor,
    FrameSource,
    GuardedTopic,
    Mode,
    OnError,
    OnSilence,
    Plan,
    PolicyName,
    StopProfile,
    WatchedFlow,
)

SPEED = """\
rsrcn:
  mode: enforce
  policy: Safe+Constrain
  threshold: 2 cm/frame
  max_vel_limit: 0.8 km/h
  max_turn_limit: 90 deg/s
  max_side_limit: 10 cm/s
  max_accel_limit: 0.5 m/s2
  lowest: 2 cm/s
  vflows:
    - topic: /max_vel
      type: std_msgs/Float64
      flows:
        - {name: v1, publisher: /lane, priority: 2}
        - {name: v2, publisher: /user, priority: 1, silent_after: 2 s, on_silence: release}
  iflows: [{name: i1, topic: /signs/image, publisher: /signs}]
fps_monitor:
  - node: /signs
    topic: /signs/image
    source: detections
    window: 2 s
    silent_after: 500 ms
    camera: {name: camera, topic: /camera/image, publisher: /camera}
stop:
  decel: 1 m/s2
  angular_decel: 90 deg/s2
  within: 800 ms
  period: 20 ms
  repeat: 3 s
"""


def faults(text: str) -> list[str]:
    with pytest.raises(PlanError) as caught:
        parse_plan(text, "my.yaml")
    return str(caught.value).splitlines()


def swap(old: str, new: str, text: str = SPEED) -> str:
    assert old in text
    return text.replace(old, new, 1)


def test_everything_about_speed():
    assert parse_plan(SPEED) == Plan(
        app="",
        rsrcn=RSRCN(
            id="rsrcn",
            mode=Mode.ENFORCE,
            policy=PolicyName.SAFE_CONSTRAIN,
            threshold=0.02,
            max_vel_limit=2 / 9,
            max_turn_limit=math.pi / 2,
            max_side_limit=0.1,
            max_accel_limit=0.5,
            lowest=0.02,
            vflows=(
                GuardedTopic(
                    topic="/max_vel",
                    type="std_msgs/Float64",
                    flows=(
                        Flow(name="v1", publisher="/lane", priority=2),
                        Flow(
                            name="v2",
                            publisher="/user",
                            priority=1,
                            silent_after=2 * SECOND,
                            on_silence=OnSilence.RELEASE,
                        ),
                    ),
                ),
            ),
            iflows=(WatchedFlow(name="i1", topic="/signs/image", publisher="/signs"),),
        ),
        fps_monitor=(
            FpsMonitor(
                id="fps_signs",
                node="/signs",
                topic="/signs/image",
                source=FrameSource.DETECTIONS,
                window=2 * SECOND,
                silent_after=SECOND // 2,
                camera=WatchedFlow(name="camera", topic="/camera/image", publisher="/camera"),
            ),
        ),
        stop=StopProfile(
            decel=1.0,
            angular_decel=math.pi / 2,
            within=4 * SECOND // 5,
            period=SECOND // 50,
            repeat=3 * SECOND,
        ),
    )


def test_it_is_written_as_it_was_read():
    plan = parse_plan(SPEED)
    text = write_plan(plan)
    assert parse_plan(text) == plan
    assert "  max_vel_limit: 0.2222222222222222 m/s\n" in text
    assert "    camera: {name: camera, topic: /camera/image, publisher: /camera}\n" in text


@pytest.mark.parametrize(
    ("old", "new", "line", "fault"),
    [
        (
            "2 cm/frame",
            "2 cm/s",
            4,
            "threshold: unknown unit 'cm/s': choose from m/frame, cm/frame",
        ),
        ("2 cm/frame", "-1", 4, "threshold: '-1' is not between 1e-06 and 1000 m/frame"),
        ("2 cm/frame", ".nan", 4, "threshold: '.nan' is no distance per frame"),
        ("2 cm/frame", "[1]", 4, "threshold is a single value"),
        ("0.8 km/h", "0.8 kmh", 5, "max_vel_limit: unknown unit 'kmh': did you mean km/h?"),
        ("0.8 km/h", ".inf", 5, "max_vel_limit: '.inf' is no velocity"),
        ("0.8 km/h", "2000", 5, "max_vel_limit: '2000' is not between 0 and 1000 m/s"),
        ("0.8 km/h", "1e-7", 5, "max_vel_limit: '1e-7' is closer to 0 than 1e-06 m/s"),
        (
            "90 deg/s\n",
            "90 deg/s2\n",
            6,
            "max_turn_limit: unknown unit 'deg/s2': did you mean deg/s",
        ),
        ("90 deg/s\n", "-1\n", 6, "max_turn_limit: '-1' is not between 0 and 1000 rad/s"),
        ("10 cm/s", "10 cm", 7, "max_side_limit: unknown unit 'cm'"),
        ("0.5 m/s2", "0", 8, "max_accel_limit: '0' is not between 0.01 and 1000 m/s2"),
        ("0.5 m/s2", ".nan", 8, "max_accel_limit: '.nan' is no acceleration"),
        ("2 cm/s", "-2 cm/s", 9, "lowest: '-2 cm/s' is not between 0 and 1000 m/s"),
        ("Safe+Constrain", "Safe + Constrain", 3, "did you mean Safe+Constrain?"),
        ("Safe+Constrain", "Constrain+Safe", 3, "unknown word 'Constrain+Safe': did you mean"),
        ("Safe+Constrain", "Preemption", 3, "Preemption is not for the RSRCN: choose from Block,"),
        ("  threshold: 2 cm/frame\n", "", 3, "Safe+Constrain needs a threshold"),
        ("  max_vel_limit: 0.8 km/h\n", "", 3, "Safe+Constrain needs a max_vel_limit"),
        ("std_msgs/Float64", "std_msgs/Int64", 12, "cannot limit a std_msgs/Int64: it knows std_"),
        ("silent_after: 2 s", "silent_after: 0", 15, "silent_after: '0' is not between 0.01 s and"),
        (
            "silent_after: 2 s",
            "silent_after: 0 ms",
            15,
            "silent_after: '0 ms' is not between 0.01 s and",
        ),
        ("on_silence: release", "on_silence: releas", 15, "did you mean release?"),
        ("on_silence: release", "on_error: stopp", 15, "did you mean stop?"),
        ("publisher: /signs}", "publisher: /sign}", 16, "no fps_monitor measures /sign on /signs/"),
        ("publisher: /signs}", "publisher: /sign}", 18, "no iflow of the RSRCN names /signs on"),
        ("source: detections", "source: frame", 20, "unknown word 'frame': did you mean frames?"),
        ("window: 2 s", "window: 99 ms", 21, "window: '99 ms' is not between 0.1 s and 60 s"),
        ("window: 2 s", "window: 499 ms", 22, "silent_after is longer than the window"),
        ("window: 2 s", "window: 61", 21, "window: '61' is not between 0.1 s and 60 s"),
        ("500 ms", "0", 22, "silent_after: '0' is not between 0.01 s and"),
        ("topic: /camera/image", "topic: /signs/image", 23, "is what /signs publishes, not what"),
        ("publisher: /camera}", "publisher: /signs}", 23, "/signs cannot be its own camera"),
        (", publisher: /camera}", "}", 23, "a watched flow needs publisher"),
        ("camera: {", "camera: yes #{", 23, "a watched flow is a mapping with name, topic, pub"),
        ("decel: 1 m/s2", "decel: 0", 25, "decel: '0' is not between 0.01 and 1000 m/s2"),
        ("decel: 1 m/s2", "decel: 1 m/s", 25, "decel: unknown unit 'm/s': did you mean m/s"),
        ("decel: 1 m/s2", "decl: 1", 25, "unknown key 'decl' in the stop: did you mean decel?"),
        ("90 deg/s2", "90 deg", 26, "angular_decel: unknown unit 'deg': did you mean deg/s"),
        ("within: 800 ms", "within: 49 ms", 27, "within: '49 ms' is not between 0.05 s and 10 s"),
        ("within: 800 ms", "within: 10001 ms", 27, "within: '10001 ms' is not between 0.05 s and"),
        ("within: 800 ms", "within: 0", 27, "within: '0' is not between 0.05 s and 10 s"),
        ("period: 20 ms", "period: 999 us", 28, "period: '999 us' is not between 0.001 s and 1 s"),
        ("period: 20 ms", "period: 1001 ms", 28, "period: '1001 ms' is not between 0.001 s and"),
        ("repeat: 3 s", "repeat: -3 s", 29, "repeat: '-3 s' is no duration"),
        ("repeat: 3 s", "repeat: null", 29, "repeat: 'null' is no duration"),
    ],
)
def test_a_slip_is_told_with_its_line(old, new, line, fault):
    told = faults(swap(old, new))
    assert any(text.startswith(f"my.yaml:{line}: ") and fault in text for text in told), told


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("window: 2 s", "window: 500 ms"),
        ("window: 2 s\n    silent_after: 500 ms", "window: 100 ms\n    silent_after: 100 ms"),
        ("window: 2 s", "window: 60 s"),
        ("period: 20 ms", "period: 1 ms"),
        ("period: 20 ms", "period: 1 s"),
        ("repeat: 3 s", "repeat: 0"),
        ("within: 800 ms", "within: 50 ms"),
        ("within: 800 ms", "within: 10 s"),
        ("  within: 800 ms\n", ""),
        ("90 deg/s\n", "0\n"),
        ("10 cm/s", "0"),
        ("0.5 m/s2", "0.01"),
        ("silent_after: 2 s", "silent_after: 10 ms"),
        ("lowest: 2 cm/s", "lowest: 0"),
        ("camera: {name: camera, topic: /camera/image, publisher: /camera}", "camera: null"),
        ("std_msgs/Float64", "std_msgs/msg/Float32"),
        ("std_msgs/Float64", "geometry_msgs/Twist"),
        ("std_msgs/Float64", "geometry_msgs/msg/TwistStamped"),
        ("std_msgs/Float64", "ackermann_msgs/AckermannDrive"),
        ("std_msgs/Float64", "ackermann_msgs/msg/AckermannDriveStamped"),
        ("std_msgs/Float64", "''"),
        ("  iflows: [{name: i1, topic: /signs/image, publisher: /signs}]\n", ""),
        ("      type: std_msgs/Float64\n", ""),
    ],
)
def test_what_is_just_right(old, new):
    plan = parse_plan(swap(old, new))
    assert parse_plan(write_plan(plan)) == plan


def test_errors_may_only_drop():
    plan = parse_plan(swap("on_silence: release", "on_error: drop"))
    assert plan.rsrcn.vflows[0].flows[1].on_error is OnError.DROP


def test_vflows_have_one_order_or_none():
    third = "        - {name: v3, publisher: /x, priority: 1}\n"
    told = faults(swap("  iflows", f"{third}  iflows"))
    assert told == [
        "my.yaml:16: v2 and v3 have the same priority 1: who goes first with Safe+Constrain?"
    ]
    same = swap("  iflows", f"{third}  iflows").replace("priority: 2", "priority: 1")
    assert parse_plan(same)
    assert parse_plan(swap("  iflows", f"{third}  iflows").replace("Safe+C", "C"))


@pytest.mark.parametrize(
    ("policy", "needs"),
    [
        ("Block", []),
        ("Safe", ["a threshold", "an fps_monitor"]),
        ("Constrain", ["a max_vel_limit"]),
        ("Safe+Constrain", ["a threshold", "an fps_monitor", "a max_vel_limit"]),
    ],
)
def test_what_each_policy_needs(policy, needs):
    text = f"rsrcn:\n  mode: enforce\n  policy: {policy}\n"
    if not needs:
        assert parse_plan(text)
        return
    told = faults(text)
    assert len(told) == len(needs)
    for what in needs:
        assert any(text.startswith(f"my.yaml:3: {policy} needs {what}") for text in told)


def test_a_parameter_that_the_policy_does_not_use_may_stand_there():
    for policy in ("Block", "Safe", "Constrain"):
        assert parse_plan(SPEED.replace("Safe+Constrain", policy)).rsrcn.threshold == 0.02


def test_a_type_that_is_not_decoded_is_fine_where_nothing_is_limited():
    text = SPEED.replace("Safe+Constrain", "Block").replace("std_msgs/Float64", "a/B")
    assert parse_plan(text)


def test_monitors_need_no_rsrcn():
    alone = SPEED[SPEED.index("fps_monitor:") :]
    assert parse_plan(alone).fps_monitor == parse_plan(SPEED).fps_monitor

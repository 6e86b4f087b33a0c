"""Positions in expressions: in the frame asked for, brought there by a transform, or not known."""

import math
import struct
from dataclasses import replace

import pytest
from message_samples import ENCODINGS, POSE, encode, header, make, pose, pose_stamped, square

from rtron.errors import InputError
from rtron.messages import (
    DefinitionRegistry,
    Encoding,
    MessageEvaluator,
    check_expression,
    parse_definition,
)
from rtron.vocabulary import MessageDefinition, Transform

pytest.importorskip("cel_expr_python.cel", reason="no CEL on this machine")
GOAL = MessageDefinition(
    type="move_base_msgs/MoveBaseActionGoal",
    definition="Header header\nactionlib_msgs/GoalID goal_id\nMoveBaseGoal goal\n"
    "===\nMSG: move_base_msgs/MoveBaseGoal\ngeometry_msgs/PoseStamped target_pose\n",
)
KNOWN = DefinitionRegistry([GOAL])
AREAS = (square(),)
INSIDE = "inside(event.pose.position, zone)"
QUARTER = Transform(source="odom", target="map", x=10.0, y=0.0, yaw=math.pi / 2)
NOT_KNOWN = "positions are in frame odom, the rule asks for map, and no transform is configured"


def judge(text, message, type=POSE, frame="", transforms=(), areas=AREAS):
    judged = MessageEvaluator(
        KNOWN.find(type), [text], subject="event", encoding=Encoding.ROS1, areas=areas,
        transforms=transforms, frames=[frame],
    )  # fmt: skip
    return judged.evaluate(message)[0]


def goal(outer, inner, x=1.0, y=2.0):
    """Return a MoveBaseActionGoal, which rosbags does not know."""
    parts = [
        encode(Encoding.ROS1, "std_msgs/Header", header(Encoding.ROS1, outer))[4:],
        struct.pack("<III", 0, 0, 0),
        pose_stamped(Encoding.ROS1, inner, x, y)[4:],
    ]
    return struct.pack("<I", sum(map(len, parts))) + b"".join(parts)


def path(outer, *inner):
    type = "nav_msgs/Path"
    poses = [
        make(Encoding.ROS1, POSE, header(Encoding.ROS1, each), pose(Encoding.ROS1))
        for each in inner
    ]
    return encode(
        Encoding.ROS1, type, make(Encoding.ROS1, type, header(Encoding.ROS1, outer), poses)
    )


@pytest.mark.parametrize("frame", ["map", "/map"])
@pytest.mark.parametrize("area", ["map", "/map"])
def test_same_frame(frame, area):
    areas = [square(frame=area)]
    for asked in ("", "map", "/map"):
        message = pose_stamped(Encoding.ROS1, frame)
        assert judge(INSIDE, message, frame=asked, areas=areas) is True
        assert judge(INSIDE, pose_stamped(Encoding.ROS1, frame, x=5.0), areas=areas) is False


def test_other_frame():
    assert judge(INSIDE, pose_stamped(Encoding.ROS1, "odom")) == NOT_KNOWN


@pytest.mark.parametrize("frame", ["", "/"])
def test_no_frame(frame):
    found = judge(INSIDE, pose_stamped(Encoding.ROS1, frame))
    assert found == "positions are in no frame, the rule asks for map"


def test_outside_after_the_transform():
    message = pose_stamped(Encoding.ROS1, "odom", 2.0, 2.0)
    assert judge(INSIDE, message, transforms=[QUARTER]) is False


@pytest.mark.parametrize(
    ("transform", "place", "target"),
    [
        (QUARTER, (1.0, 8.0), (2.0, 1.0)),
        (replace(QUARTER, source="/odom", target="/map"), (1.0, 8.0), (2.0, 1.0)),
        (replace(QUARTER, source="map", target="odom"), (9.0, 1.0), (1.0, 1.0)),
    ],
)
def test_transforms_there_and_back(transform, place, target):
    """The place, not in the zone as it stands in odom, lies at the target in map."""
    message = pose_stamped(Encoding.ROS1, "odom", *place)
    near = "distance(event.pose.position, place({}, {})) < 1e-9"
    assert judge(INSIDE, message, transforms=[transform]) is True
    assert judge(near.format(*target), message, frame="map", transforms=[transform]) is True
    text = (
        f"event.pose.position.x < {target[0]} + 1e-9 && event.pose.position.x > {target[0]} - 1e-9"
    )
    assert judge(text, message, frame="map", transforms=[transform]) is True
    assert judge(f"event.pose.position.x == {place[0]}", message, transforms=[transform]) is True


def test_texts_in_different_frames_in_one_judge():
    texts = [INSIDE, "event.pose.position.x == 1.0", "inside(event.pose.position, other)",
             "event.pose.position.x == 1.0"]  # fmt: skip
    judged = MessageEvaluator(
        KNOWN.find(POSE), texts, subject="event", encoding=Encoding.ROS1,
        areas=[square(), square("other", "odom", 9.0)], transforms=[QUARTER],
        frames=["", "", "", "map"],
    )  # fmt: skip
    assert judged.evaluate(pose_stamped(Encoding.ROS1, "odom", 1.0, 8.0)) == (
        True,
        True,
        True,
        False,
    )
    found = judged.evaluate(pose_stamped(Encoding.ROS1, "base", 1.0, 8.0))
    assert found[1] is True
    assert all("in frame base" in found[index] for index in (0, 2, 3))


@pytest.mark.parametrize(
    ("outer", "inner", "expected"),
    [
        ("", "map", True),
        ("odom", "map", True),
        ("map", "", True),
        ("map", "odom", NOT_KNOWN),
        ("", "odom", NOT_KNOWN),
        ("", "", "positions are in no frame, the rule asks for map"),
    ],
)
def test_a_goal_is_in_the_frame_of_its_own_pose(outer, inner, expected):
    text = "inside(event.goal.target_pose.pose.position, zone)"
    assert judge(text, goal(outer, inner), "move_base_msgs/MoveBaseActionGoal") == expected


@pytest.mark.parametrize(
    ("inner", "expected"),
    [(["map", ""], True), ([], True), (["map", "odom"], NOT_KNOWN), (["odom"], NOT_KNOWN)],
)
def test_every_position_must_be_in_the_frame(inner, expected):
    text = "event.poses.all(p, inside(p.pose.position, zone))"
    assert judge(text, path("map", *inner), "nav_msgs/Path") == expected


def test_positions_that_are_not_asked_for_do_not_count():
    assert judge("event.header.seq == 7", path("map", "odom"), "nav_msgs/Path", frame="map") is True


@pytest.mark.parametrize(
    ("areas", "text", "frame"),
    [
        (
            [square(), square("other", "odom")],
            f"{INSIDE} && inside(event.pose.position, other)",
            "",
        ),
        ([square()], INSIDE, "odom"),
        ([square(frame="")], INSIDE, "odom"),
    ],
)
def test_frames_that_disagree(areas, text, frame):
    with pytest.raises(InputError, match="different frames"):
        check_expression(KNOWN.find(POSE), text, "event", areas, frame=frame)


@pytest.mark.parametrize("text", ["place(1.0, 2.0)", "place (1.0, 2.0)", "place//\n(1.0, 2.0)"])
def test_a_place_needs_a_frame(text):
    text = f"distance(event.pose.position, {text}) < 1.0"
    with pytest.raises(InputError, match="in no frame"):
        check_expression(KNOWN.find(POSE), text, "event")
    check_expression(KNOWN.find(POSE), text, "event", frame="map")


@pytest.mark.parametrize("type", ["geometry_msgs/Pose", "geometry_msgs/Point", "std_msgs/Float64"])
def test_no_header(type):
    with pytest.raises(InputError, match="has no header that tells the frame"):
        check_expression(KNOWN.find(type), "event == event", "event", frame="map")


def test_header_without_frame():
    text = "Header header\ngeometry_msgs/Point p\n===\nMSG: std_msgs/Header\ntime stamp"
    definition = parse_definition("a/B", text, lookup=KNOWN.find)
    with pytest.raises(InputError, match="has no header"):
        check_expression(definition, "inside(event.p, zone)", "event", [square()])


def test_only_some_positions_have_a_header():
    text = "geometry_msgs/PointStamped one\ngeometry_msgs/Pose other"
    definition = parse_definition("a/B", text, lookup=KNOWN.find)
    check_expression(definition, "inside(event.one.point, zone)", "event", [square()])
    with pytest.raises(InputError, match="has no header"):
        check_expression(definition, "inside(event.other.position, zone)", "event", [square()])


@pytest.mark.parametrize(("frame", "expected"), [("map", True), ("odom", None)])
def test_coordinates_that_are_no_points_are_not_transformed(frame, expected):
    definition = parse_definition("a/B", "Header header\nfloat64 x", lookup=KNOWN.find)
    head = encode(Encoding.ROS1, "std_msgs/Header", header(Encoding.ROS1, frame))[4:]
    message = struct.pack("<I", len(head) + 8) + head + struct.pack("<d", 1.0)
    judged = MessageEvaluator(
        definition, ["event.x == 1.0"], subject="event", encoding=Encoding.ROS1,
        frames=["map"], transforms=[QUARTER],
    ).evaluate(message)  # fmt: skip
    if expected:
        assert judged == (True,)
    else:
        assert "it has no points to transform" in judged[0]


@pytest.mark.parametrize(("frames", "expected"), [("map map", True), ("map odom", NOT_KNOWN)])
def test_two_positions_of_one_type(frames, expected):
    text = f"{POSE} one\n{POSE} two"
    definition = parse_definition("a/B", text, lookup=KNOWN.find)
    body = b"".join(pose_stamped(Encoding.ROS1, frame)[4:] for frame in frames.split())
    judged = MessageEvaluator(
        definition, ["inside(event.one.pose.position, zone) && has(event.two)"], subject="event",
        encoding=Encoding.ROS1, areas=AREAS,
    )  # fmt: skip
    assert judged.evaluate(struct.pack("<I", len(body)) + body) == (expected,)


def test_parts_without_positions_are_not_visited():
    """A header in each of them, but nothing that is anywhere."""
    text = "Header header\nInner[] inner\ngeometry_msgs/Point p\n===\nMSG: a/Inner\nHeader header"
    definition = parse_definition("a/B", text, lookup=KNOWN.find)
    head = encode(Encoding.ROS1, "std_msgs/Header", header(Encoding.ROS1))[4:]
    other = encode(Encoding.ROS1, "std_msgs/Header", header(Encoding.ROS1, "odom"))[4:]
    body = head + struct.pack("<I", 1) + other + struct.pack("<3d", 1.0, 1.0, 0.0)
    judged = MessageEvaluator(
        definition, ["inside(event.p, zone) && size(event.inner) == 1"], subject="event",
        encoding=Encoding.ROS1, areas=AREAS,
    )  # fmt: skip
    assert judged.evaluate(struct.pack("<I", len(body)) + body) == (True,)


def test_own_transform_before_the_inverse_of_another():
    back = Transform(source="map", target="odom", x=100.0)
    message = pose_stamped(Encoding.ROS1, "odom", 1.0, 8.0)
    for transforms in ([QUARTER, back], [back, QUARTER]):
        assert judge(INSIDE, message, transforms=transforms) is True


def test_a_point_type_of_another_shape_is_no_position():
    text = "Header header\ngeometry_msgs/Point p\n===\nMSG: geometry_msgs/Point\nstring x\n"
    definition = parse_definition("a/B", text, lookup=KNOWN.find)
    with pytest.raises(InputError, match="nothing is called 'inside'"):
        check_expression(definition, "inside(event.p, zone)", "event", [square()])


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_either_encoding(encoding):
    known = DefinitionRegistry(ros=1 if encoding is Encoding.ROS1 else 2)
    judged = MessageEvaluator(
        known.find(POSE), [INSIDE], subject="event", encoding=encoding, areas=[square()]
    )
    assert judged.evaluate(pose_stamped(encoding)) == (True,)
    assert "in frame odom" in judged.evaluate(pose_stamped(encoding, "odom"))[0]

"""The messages of an action, against those that rosbags writes, and broken ones."""

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from rtron.errors import WireError
from rtron.messages.ros1.actions import (
    MAX_STATUSES,
    GoalID,
    GoalStatus,
    after_header,
    cancel_message,
    read_cancel,
    read_goal,
    read_result,
    read_statuses,
    result_message,
    stamp_of,
    with_goal_id,
    with_statuses,
)
from rtron.vocabulary import SECOND

STORE = get_typestore(Stores.ROS1_NOETIC)
HEAD = "std_msgs/Header header\n"
for name, text in {
    "demo_msgs/msg/GoActionGoal": HEAD + "actionlib_msgs/GoalID goal_id\ngeometry_msgs/Point goal",
    "demo_msgs/msg/GoActionResult": HEAD + "actionlib_msgs/GoalStatus status\nstring result",
}.items():
    STORE.register(get_types_from_msg(text, name))
TYPES = STORE.types
texts = st.text(st.characters(codec="utf-8"), max_size=20)
stamps = st.integers(0, (1 << 31) * SECOND - 1)  # rosbags reads the seconds as signed
goal_ids = st.builds(lambda name, stamp: GoalID(name.encode(), stamp), texts, stamps)
statuses = st.builds(GoalStatus, goal_ids, st.integers(0, 9), texts)


def framed(message):
    raw = bytes(STORE.serialize_ros1(message, message.__msgtype__))
    return struct.pack("<I", len(raw)) + raw


def made(type, *fields):
    return TYPES[type](*fields)


def time(stamp):
    return made("builtin_interfaces/msg/Time", *divmod(stamp, SECOND))


def header(stamp=0, frame=""):
    return made("std_msgs/msg/Header", 7, time(stamp), frame)


def goal_id(goal):
    return made("actionlib_msgs/msg/GoalID", time(goal.stamp), goal.id.decode())


def status_of(status):
    return made("actionlib_msgs/msg/GoalStatus", goal_id(status.goal), status.status, status.text)


def goal_of(goal, frame=""):
    point = made("geometry_msgs/msg/Point", 1.0, 2.0, 3.0)
    return framed(made("demo_msgs/msg/GoActionGoal", header(0, frame), goal_id(goal), point))


def array_of(statuses, frame=""):
    entries = [status_of(each) for each in statuses]
    return framed(made("actionlib_msgs/msg/GoalStatusArray", header(0, frame), entries))


def plain(statuses):
    return [(each.goal, each.status) for each in statuses]


@given(goal_ids, goal_ids, texts)
def test_the_id_of_a_goal_is_read_and_replaced(goal, other, frame):
    message = goal_of(goal, frame)
    assert read_goal(message) == goal
    assert with_goal_id(message, other) == goal_of(other, frame)


@given(goal_ids)
def test_cancels(goal):
    assert read_cancel(framed(goal_id(goal))) == goal
    assert cancel_message(goal.id) == framed(goal_id(GoalID(goal.id, 0)))


@given(st.lists(statuses, max_size=4), st.lists(statuses, max_size=4), texts)
def test_statuses_are_read_and_added(told, more, frame):
    message = array_of(told, frame)
    assert read_statuses(message) == {each.goal.id: each.status for each in told}
    assert after_header(message) == after_header(array_of(told, frame + "other"))
    assert with_statuses(message, more) == array_of([*told, *more], frame)


@given(st.lists(statuses, min_size=1, max_size=4, unique_by=lambda each: each.goal.id))
def test_the_stamp_of_a_listed_goal_is_found(told):
    first = told[0].goal
    assert stamp_of(array_of(told[:1]), first.id) == first.stamp


@pytest.mark.parametrize("id", [b"other", b"an id that is longer than the whole message" * 9])
def test_a_goal_that_is_not_listed_has_no_stamp(id):
    with pytest.raises(WireError, match="not listed"):
        stamp_of(array_of([GoalStatus(GoalID(b"id", 5), 1)]), id)


@given(statuses, stamps, texts)
def test_results_are_read_and_written(status, stamp, rest):
    empty = made("std_msgs/msg/Header", 0, time(stamp), "")
    message = framed(made("demo_msgs/msg/GoActionResult", empty, status_of(status), rest))
    assert plain([read_result(message)]) == plain([status])
    encoded = rest.encode()
    assert result_message(stamp, status, struct.pack("<I", len(encoded)) + encoded) == message


def test_a_clock_before_1970_keeps_no_result_back():
    status = GoalStatus(GoalID(b"goal", 1), 3)
    assert read_result(result_message(-5, status, b"")) == status


def test_ids_need_not_be_text():
    message = with_goal_id(goal_of(GoalID(b"", 0)), GoalID(b"\xff\x00", 0))
    assert read_goal(message).id == b"\xff\x00"


READERS = (read_goal, read_cancel, read_statuses, read_result)


@pytest.mark.parametrize("reader", READERS)
@given(data=st.binary(max_size=80))
def test_whatever_arrives_is_read_or_refused(reader, data):
    try:
        found = reader(data)
    except WireError:
        return
    assert isinstance(found, GoalID | GoalStatus | dict)


@pytest.mark.parametrize("change", [with_statuses, with_goal_id])
@given(data=st.binary(max_size=80))
def test_whatever_arrives_is_changed_or_refused(change, data):
    more = GoalID(b"x", 1) if change is with_goal_id else [GoalStatus(GoalID(b"x", 1), 0)]
    try:
        changed = change(data, more)
    except WireError:
        return
    assert len(changed) == 4 + int.from_bytes(changed[:4], "little")


@pytest.mark.parametrize("reader", READERS)
def test_no_cut_message_is_read(reader):
    status = GoalStatus(GoalID(b"id", 1), 1, "text")
    whole = {
        read_goal: goal_of(GoalID(b"id", 1))[:-24],
        read_cancel: framed(goal_id(GoalID(b"id", 1))),
        read_statuses: array_of([status]),
        read_result: result_message(1, status, b""),
    }[reader]
    reader(whole)
    for length in range(len(whole)):
        with pytest.raises(WireError):
            reader(whole[:length])


@pytest.mark.parametrize(("count", "read"), [(MAX_STATUSES, True), (MAX_STATUSES + 1, False)])
def test_the_list_of_goals_is_bounded(count, read):
    told = [GoalStatus(GoalID(b"%d" % number, 0), 3) for number in range(count)]
    message = with_statuses(array_of([]), told)
    if read:
        assert len(read_statuses(message)) == count
    else:
        with pytest.raises(WireError, match="a status of 10001 goals"):
            read_statuses(message)

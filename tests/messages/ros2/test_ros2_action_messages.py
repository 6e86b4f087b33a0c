"""Status arrays and feedback of ROS 2 as bytes, compared with what rosbags writes."""

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_typestore

from rtron.errors import WireError
from rtron.messages.ros2.actions import (
    MAX_STATUSES,
    GoalStatus,
    feedback_id,
    read_statuses,
    status_array,
)
from rtron.vocabulary import SECOND

STATUSES = st.lists(
    st.builds(
        GoalStatus,
        st.binary(min_size=16, max_size=16),
        st.integers(0, (1 << 31) * SECOND - 1),
        st.integers(-128, 127),
    ),
    max_size=5,
)
TWO = status_array([GoalStatus(b"a" * 16, 3 * SECOND + 4, 2), GoalStatus(b"b" * 16, 0, 6)])


@given(STATUSES)
def test_what_is_written_is_read(statuses):
    assert read_statuses(status_array(statuses)) == statuses


@pytest.mark.parametrize("little", [True, False])
def test_is_as_rosbags_writes_it(little):
    import numpy as np  # noqa: PLC0415 - comes with rosbags

    store = get_typestore(Stores.ROS2_HUMBLE)
    array, status, info, uuid, time = (
        store.types[name]
        for name in (
            "action_msgs/msg/GoalStatusArray",
            "action_msgs/msg/GoalStatus",
            "action_msgs/msg/GoalInfo",
            "unique_identifier_msgs/msg/UUID",
            "builtin_interfaces/msg/Time",
        )
    )
    made = [
        status(info(uuid(np.frombuffer(id * 16, dtype=np.uint8)), time(*stamp)), state)
        for id, stamp, state in ((b"a", (3, 4), 2), (b"b", (0, 0), 6))
    ]
    kind = "action_msgs/msg/GoalStatusArray"
    written = bytes(store.serialize_cdr(array(made), kind, little_endian=little))
    assert read_statuses(written) == read_statuses(TWO)
    assert (written == TWO) is little


@pytest.mark.parametrize("length", range(len(TWO)))
def test_what_is_too_short_is_refused(length):
    with pytest.raises(WireError):
        read_statuses(TWO[:length])


@pytest.mark.parametrize(
    "message",
    [
        b"\0\1\0\0" + struct.pack("<I", MAX_STATUSES + 1) + bytes(29 * (MAX_STATUSES + 1)),
        b"\0\2\0\0" + bytes(4),
        b"\1\1\0\0" + bytes(4),
        b"",
    ],
)
def test_what_is_too_long_or_no_plain_cdr_is_refused(message):
    with pytest.raises(WireError):
        read_statuses(message)


def test_a_stamp_beyond_the_type_is_cut():
    (told,) = read_statuses(status_array([GoalStatus(bytes(16), 1 << 70, 1)]))
    assert told.stamp == (1 << 31) * SECOND - 1
    (told,) = read_statuses(status_array([GoalStatus(bytes(16), -1, 1)]))
    assert told.stamp == 0


def test_feedback_begins_with_the_id():
    assert feedback_id(b"\0\1\0\0" + b"x" * 16 + b"more") == b"x" * 16
    for message in (b"\0\1\0\0" + b"x" * 15, b"\0\7\0\0" + b"x" * 16, b"\0\1\0"):
        with pytest.raises(WireError):
            feedback_id(message)

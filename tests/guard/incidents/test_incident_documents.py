"""What is written of an entry, whatever its texts and numbers are."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

from rtron.guard.incidents.documents import DECISION_CHANNEL, EntryDocuments
from rtron.guard.incidents.entries import (
    AlarmSwitched,
    ControlState,
    EntriesLost,
    EventMessage,
    LearnedType,
    LeaseAnswered,
    Observed,
    Received,
    RevisionChanged,
    RuleSwitched,
    Sent,
)
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import Decision, PolicyName

VALID = Draft202012Validator(json.loads(DECISION_CHANNEL.definition))
text = st.text(max_size=5)
number = st.none() | st.floats()
at = st.integers(0, 2**63)
size = st.integers(0, 2**32)
age = st.none() | at
ENTRIES = [
    st.builds(
        Received, at, text, text, st.just(b""), size, text, st.sampled_from(Decision),
        st.sampled_from(PolicyName) | st.just(""), text, st.integers(0, 2**63),
    ),
    st.builds(Sent, at, text, text, st.just(b""), size, text),
    st.builds(ControlState, at, text, text, text, text, number, number),
    st.builds(RuleSwitched, at, text, st.booleans(), text),
    st.builds(LeaseAnswered, at, text, text, st.booleans(), text),
    st.builds(
        Observed,
        at,
        st.tuples(st.tuples(text, st.floats(), at)),
        st.tuples(st.tuples(text, size, age, st.none() | st.booleans(), age, size)),
    ),
    st.builds(AlarmSwitched, at, text, text, text, st.booleans()),
    st.builds(RevisionChanged, at, size, st.just('{"revision": 3}')),
    st.builds(EntriesLost, at, size),
]  # fmt: skip


@given(st.one_of(ENTRIES))
def test_every_decision_is_json_as_the_schema_says(entry):
    (found,) = EntryDocuments(Encoding.ROS1).of(entry)
    channel, data = found
    assert channel == DECISION_CHANNEL

    def refuse(constant):
        raise AssertionError(constant)

    document = json.loads(data, parse_constant=refuse)
    VALID.validate(document)


TWIST = "geometry_msgs/Twist"


def learned(encoding, definition="float64 x"):
    documents = EntryDocuments(encoding)
    flows = (("flow1", "/teleop"),)
    documents.learn(LearnedType("/cmd_vel", TWIST, "9f19", definition, flows))
    return documents


def sent(message):
    return Sent(1, "/cmd_vel", "flow1", message, len(message), "")


def test_a_message_of_ros_1_is_written_without_its_length_and_names_its_publisher():
    entry = Received(1, "/cmd_vel", "flow1", b"\4\0\0\0body", 8, "", "pass", "", "", 0)
    (channel, data), _ = learned(Encoding.ROS1).of(entry)
    assert (channel.topic, channel.encoding) == ("/rtron/cmd_vel/flow1", "ros1")
    assert (channel.schema, channel.format, channel.definition) == (TWIST, "ros1msg", "float64 x")
    assert dict(channel.metadata) == {"callerid": "/teleop", "md5sum": "9f19"}
    assert data == b"body"


def test_a_message_of_ros_2_is_written_as_it_is():
    ((channel, data),) = learned(Encoding.CDR).of(sent(b"\0\1\0\0body"))
    assert (channel.topic, channel.encoding) == ("/rtron/cmd_vel/out", "cdr")
    assert (channel.schema, channel.format) == ("geometry_msgs/msg/Twist", "ros2msg")
    assert data == b"\0\1\0\0body"


@pytest.mark.parametrize("encoding", Encoding)
def test_a_standard_type_that_nobody_has_defined_has_its_definition(encoding):
    (channel, _), *_ = learned(encoding, "").of(sent(b"\0\1\0\0body"))
    assert "Vector3" in channel.definition


def test_a_type_that_nobody_knows_has_no_schema():
    documents = EntryDocuments(Encoding.ROS1)
    documents.learn(LearnedType("/cmd_vel", "my_msgs/Odd", "*", "", ()))
    ((channel, _),) = documents.of(sent(b"\4\0\0\0body"))
    assert (channel.format, channel.definition) == ("", "")


def test_a_message_whose_type_is_not_known_yet_leaves_its_verdict():
    entry = Received(1, "/cmd_vel", "flow1", b"\4\0\0\0body", 8, "", "pass", "", "", 0)
    ((channel, _),) = EntryDocuments(Encoding.ROS1).of(entry)
    assert channel == DECISION_CHANNEL


def test_an_event_is_on_its_topic_as_the_app_calls_it():
    what = ("/pose", "/amcl", "geometry_msgs/PoseStamped", "d381", "float64 x")
    event = EventMessage(1, *what, b"\4\0\0\0body")
    ((channel, data),) = EntryDocuments(Encoding.ROS1).of(event)
    assert (channel.topic, dict(channel.metadata)["callerid"]) == ("/pose", "/amcl")
    assert data == b"body"

"""Events of service introspection, as rosbags writes them: whose they are, and the goal in them."""

from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st
from service_events import (
    ANSWERED,
    GOAL,
    HEARD,
    RECEIVED,
    SENT,
    cancel_request_event,
    goal,
    goal_request_event,
    goal_response_event,
)

from rtron.errors import WireError
from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.common.definition_registry import DefinitionRegistry
from rtron.messages.ros2.cdr_validator import cdr_validator
from rtron.messages.ros2.service_events import (
    message_extractor,
    read_answer,
    read_cancel,
    read_event,
    read_goal,
)
from rtron.vocabulary import SECOND

DEFINITION = parse_definition("my_msgs/Dig_Goal", GOAL, lookup=DefinitionRegistry(ros=2).find)
EMPTY = parse_definition("my_msgs/Nothing", "")


@pytest.mark.parametrize("kind", [SENT, RECEIVED])
def test_who_asks_for_which_goal(kind):
    message = goal_request_event(9, kind=kind, asker=3, number=1 << 40)
    event = read_event(message)
    assert (event.is_request, event.client_gid, event.sequence_number) == (
        True,
        b"\3" * 16,
        1 << 40,
    )
    assert read_goal(message, event.content_offset)[0] == b"\x09" * 16


@pytest.mark.parametrize("kind", [ANSWERED, HEARD])
@pytest.mark.parametrize("accepted", [True, False])
def test_what_the_server_answers(kind, accepted):
    message = goal_response_event(4, kind=kind, accepted=accepted, stamp=6)
    event = read_event(message)
    assert (event.is_request, event.sequence_number) == (False, 4)
    assert read_answer(message, event.content_offset) == (6 * SECOND if accepted else None)


def test_what_a_cancel_means():
    message = cancel_request_event(2, stamp=8)
    assert read_cancel(message, read_event(message).content_offset) == (b"\2" * 16, 8 * SECOND)


def test_metadata_alone_have_no_contents():
    assert read_event(goal_request_event(1, contents=False)).content_offset == 0
    assert read_event(goal_request_event(1, kind=ANSWERED, contents=False)).content_offset == 0


@given(
    tool=st.text(max_size=9).filter(lambda text: "\0" not in text),
    depth=st.floats(allow_nan=False),
    cells=st.integers(0, 9),
)
def test_a_goal_is_the_message_that_it_would_be_by_itself(tool, depth, cells):
    message = goal_request_event(1, depth, tool=tool, cells=cells)
    found = message_extractor(DEFINITION)(
        message, read_goal(message, read_event(message).content_offset)[1]
    )
    assert found == goal(depth, tool=tool, cells=cells)[: len(found)]
    cdr_validator(DEFINITION)(found)


def test_a_message_without_fields_is_one_byte():
    assert message_extractor(EMPTY)(b"\0\1\0\0abc", 5) == b"\0\1\0\0b"


@pytest.mark.parametrize(
    "message", [goal_request_event(1), cancel_request_event(1), goal_response_event(1)]
)
def test_what_ends_too_early_is_refused(message):
    for size in range(len(message) - 8):
        with pytest.raises(WireError):
            _read(message[:size])


@pytest.mark.parametrize("head", [b"\0\0\0\0", b"\0\7\0\0", b"\1\1\0\0"])
def test_another_encapsulation_is_refused(head):
    with pytest.raises(WireError):
        read_event(head + goal_request_event(1)[4:])


@given(data=st.binary(max_size=200), at=st.integers(0, 250))
def test_garbage_is_refused_or_read(data, at):
    for message in (b"\0\1\0\0" + data, goal_request_event(1)[:at] + data):
        with suppress(WireError):
            _read(message)


def _read(message):
    event = read_event(message)
    if not event.content_offset:
        raise WireError("no contents")
    if not event.is_request:
        read_answer(message, event.content_offset)
    elif len(message) < len(goal_request_event(1)) - 60:
        read_cancel(message, event.content_offset)
    else:
        message_extractor(DEFINITION)(message, read_goal(message, event.content_offset)[1])

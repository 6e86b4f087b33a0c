from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtron.errors import WireError
from rtron.vocabulary import GuardState, Mode, OpenRequests, RuleState, StreamState
from rtron.wire.common.link_protocol import (
    NewSettings,
    StateDelta,
    StateReport,
    decode_from_guard,
    decode_to_guard,
    encode_from_guard,
)
from rtron.wire.common.state_deltas import apply_state_delta, state_delta

TOPICS = ("/a", "/b", "/c")

streams = st.tuples(
    *(
        st.builds(
            StreamState,
            topic=st.just(topic),
            nodes=st.just(("grcn",)),
            mode=st.just(Mode.ENFORCE),
            owner=st.sampled_from(("", "flow1")),
        )
        for topic in TOPICS
    )
)
states = st.builds(
    GuardState,
    at=st.integers(0, 9),
    revision=st.integers(0, 2),
    streams=streams,
    rules=st.sampled_from(((), (RuleState(name="rule", blocks=True),))),
    bits=st.dictionaries(st.sampled_from("xy"), st.sampled_from((None, True)), max_size=2),
    overridden=st.sampled_from(((), ("grcn",))),
    stopped=st.booleans(),
    requests=st.sampled_from((None, OpenRequests(), OpenRequests(count=1))),
)


@given(states, states)
def test_a_change_makes_the_next_state_of_the_one_before_over_the_wire(before, state):
    sent = encode_from_guard(state_delta(before, state))
    assert apply_state_delta(before, decode_from_guard(sent)) == state


def test_what_is_unchanged_is_not_sent():
    before = GuardState(at=1, revision=1, streams=_streams(*TOPICS), fps={"camera": 15.0})
    after = replace(before, at=2)
    sent = encode_from_guard(state_delta(before, after))
    assert b"/a" not in sent
    assert b"camera" not in sent
    assert len(sent) < len(encode_from_guard(StateReport(state=after)))


def test_other_streams_need_the_whole_state():
    before = GuardState(at=1, revision=1, streams=_streams("/a"))
    assert state_delta(before, replace(before, streams=_streams("/a", "/b"))) is None
    assert state_delta(before, replace(before, streams=())) is None


@pytest.mark.parametrize(
    "change",
    [
        StateDelta(state=GuardState(at=1, revision=1), unchanged=("nothing",)),
        StateDelta(state=GuardState(at=1, revision=1), unchanged=("streams",)),
        StateDelta(
            state=GuardState(
                at=1, revision=1, streams=(StreamState(topic="/x", nodes=(), mode=Mode.ENFORCE),)
            )
        ),
    ],
)
def test_a_change_that_does_not_fit_is_refused(change):
    with pytest.raises(WireError):
        apply_state_delta(GuardState(at=0, revision=0, streams=_streams("/a")), change)


def test_a_service_of_the_version_before_is_sent_whole_states():
    message = decode_to_guard('{"type":"settings","settings":{"revision":1},"now":5}')
    assert isinstance(message, NewSettings)
    assert not message.takes_state_deltas


def _streams(*topics):
    return tuple(StreamState(topic=topic, nodes=(), mode=Mode.ENFORCE) for topic in topics)

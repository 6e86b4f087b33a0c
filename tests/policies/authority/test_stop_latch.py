"""The latched stop: every refusal of a release, and what holds in every sequence."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st
from policy_runs import often

from rtron.policies.authority.stop_latch import LatchedStop, StopLatch

WITHIN = 10
BUTTON, TOPIC, SERVICE, CONSOLE = "button", "topic", "service", "console"
SOURCES = (BUTTON, TOPIC, SERVICE, CONSOLE)


def stopped(by="ada", reason="a person on the track", since=3, *, is_caused=False):
    return LatchedStop(by=by, reason=reason, since=since, is_caused=is_caused)


def latched(source=SERVICE, second_within=None, **options):
    latch = StopLatch(second_within)
    assert latch.stop(source, "ada", "a person on the track", 3, **options)
    return latch


def test_at_first_nothing_is_stopped():
    latch = StopLatch()
    assert latch.stops == {}
    assert latch.reason == ""


def test_it_says_who_has_stopped_what_for():
    latch = latched()
    assert latch.stops == {SERVICE: stopped()}
    latch.stop(BUTTON, "/button", "pressed", 4, is_caused=True)
    assert latch.reason == "service by ada: a person on the track; button by /button: pressed"


def test_a_release_with_a_reason_is_enough_without_a_second_person():
    latch = latched()
    answer = latch.release(SERVICE, "bob", "the track is free", 5)
    assert answer.released
    assert answer.reason == "the stop of service is released by bob: the track is free"
    assert latch.reason == ""


@pytest.mark.parametrize("reason", ["", " ", "\t\n", "\u200b"])
def test_a_release_needs_a_reason(reason):
    latch = latched()
    answer = latch.release(SERVICE, "bob", reason, 5)
    assert not answer.released
    assert answer.reason == "to release the stop of service needs a reason"
    assert latch.stops


def test_a_release_needs_the_cause_gone():
    latch = latched(BUTTON, is_caused=True)
    answer = latch.release(BUTTON, "bob", "all is well", 5)
    assert not answer.released
    assert answer.reason == (
        "the cause of the stop of button is still there: a person on the track"
    )
    latch.end_cause(BUTTON)
    assert latch.stops[BUTTON].reason == "a person on the track"
    assert latch.release(BUTTON, "bob", "all is well", 6).released


def test_a_release_needs_neutral_inputs():
    latch = latched()
    answer = latch.release(SERVICE, "bob", "all is well", 5, moving="/teleop")
    assert not answer.released
    assert answer.reason == "/teleop is not neutral"
    assert latch.release(SERVICE, "bob", "all is well", 6).released


def test_what_has_not_stopped_is_not_released():
    latch = latched()
    answer = latch.release(CONSOLE, "bob", "all is well", 5)
    assert not answer.released
    assert answer.reason == "console has stopped nothing"
    latch.end_cause(CONSOLE)
    assert set(latch.stops) == {SERVICE}


def test_all_sources_must_have_released():
    latch = latched()
    latch.stop(CONSOLE, "cleo", "fire", 4)
    answer = latch.release(SERVICE, "bob", "all is well", 5)
    assert answer.released
    assert answer.reason.endswith("; still stopped by console")
    assert latch.reason == "console by cleo: fire"


def test_a_source_that_stops_again_keeps_its_first_reason_and_its_cause():
    latch = latched(BUTTON, is_caused=True)
    assert not latch.stop(BUTTON, "bob", "once more", 9)
    assert latch.stops == {BUTTON: stopped(is_caused=True)}
    latch.end_cause(BUTTON)
    assert not latch.stop(BUTTON, "bob", "once more", 10, is_caused=True)
    assert latch.stops[BUTTON].is_caused


def test_a_second_person_must_release_it():
    latch = latched(second_within=WITHIN)
    first = latch.release(SERVICE, "bob", "all is well", 5)
    assert not first.released
    assert first.reason.startswith("bob agrees; a second person must release it too within")
    again = latch.release(SERVICE, "bob", "all is well", 6)
    assert not again.released
    assert again.reason == "bob has agreed already: a second person must"
    assert latch.release(SERVICE, "ada", "I see it", 7).released


@pytest.mark.parametrize(
    ("after", "released"), [(0, True), (WITHIN - 1, True), (WITHIN, False), (-1, False)]
)
def test_the_second_person_has_so_long(after, released):
    latch = latched(second_within=WITHIN)
    latch.release(SERVICE, "bob", "all is well", 20)
    assert latch.release(SERVICE, "ada", "I see it", 20 + after).released is released


def test_a_stop_between_makes_both_release_again():
    latch = latched(second_within=WITHIN)
    latch.release(SERVICE, "bob", "all is well", 5)
    latch.stop(SERVICE, "cleo", "no", 6)
    assert not latch.release(SERVICE, "ada", "I see it", 7).released
    assert latch.release(SERVICE, "bob", "all is well", 8).released


def test_a_refused_release_is_no_consent():
    latch = latched(second_within=WITHIN)
    latch.release(SERVICE, "bob", "all is well", 5, moving="/teleop")
    assert not latch.release(SERVICE, "ada", "I see it", 6).released


def test_the_consent_to_one_source_is_none_to_another():
    latch = latched(second_within=WITHIN)
    latch.stop(CONSOLE, "cleo", "fire", 4)
    latch.release(SERVICE, "bob", "all is well", 5)
    assert not latch.release(CONSOLE, "ada", "all is well", 6).released


def test_it_outlives_a_restart_as_json():
    latch = latched()
    latch.stop(BUTTON, "/button", "pressed", 4, is_caused=True)
    next_one = StopLatch()
    state = json.loads(json.dumps(latch.export_state()))
    next_one.restore_state(state, 99, frozenset({BUTTON}))
    assert next_one.stops == latch.stops


@pytest.mark.parametrize("stop", [None, 3, "text", [], {}, {"since": "never"}])
def test_what_cannot_be_read_is_stopped_all_the_same(stop):
    latch = StopLatch()
    latch.restore_state({SERVICE: stop}, 99, frozenset())
    assert latch.stops == {SERVICE: stopped("somebody", "the reason cannot be read", 99)}


moments = st.lists(
    st.tuples(
        st.sampled_from([0, 1, WITHIN - 1, WITHIN]),
        st.sampled_from(["stop", "cause", "end_cause", "release", "release", "restart"]),
        st.sampled_from(SOURCES),
        st.sampled_from(["ada", "bob"]),
        st.sampled_from(["because", ""]),
        st.sampled_from(["", "", "/teleop"]),
    ),
    max_size=40,
)


@often
@given(moments, st.sampled_from([None, WITHIN]))
def test_a_stop_ends_with_a_release_that_has_all_it_needs(moments, second_within):
    latch, now, caused, consents = StopLatch(second_within), 0, set(), {}
    for gap, what, source, who, why, moving in moments:
        now += gap
        before = latch.stops
        if what in ("stop", "cause"):
            latch.stop(source, who, why, now, is_caused=what == "cause")
            caused |= {source} if what == "cause" else set()
            consents.pop(source, None)
            assert source in latch.stops
        elif what == "end_cause":
            latch.end_cause(source)
            caused.discard(source)
        elif what == "restart":
            state, latch = latch.export_state(), StopLatch(second_within)
            latch.restore_state(state, now, frozenset(caused))
            consents = {}
        else:
            answer = latch.release(source, who, why, now, moving=moving)
            fits = bool(source in before and source not in caused and why and not moving)
            other, at = consents.get(source, (who, now - WITHIN))
            in_time = now - at < WITHIN
            assert answer.released is (
                fits and (second_within is None or (in_time and other != who))
            )
            assert answer.reason
            if answer.released:
                consents.pop(source, None)
            elif fits and not in_time:
                consents[source] = (who, now)
        gone = set(before) - set(latch.stops)
        assert gone == ({source} if what == "release" and answer.released else set())
        assert bool(latch.reason) is bool(latch.stops)

"""The bits of events: from the newest message, presence or silence, and what unknown counts as."""

from itertools import product

import pytest
from event_and_rate_models import FOUND, LOST, NaiveBit
from hypothesis import given
from hypothesis import strategies as st
from policy_runs import often

from rtron.policies.mission.event_bits import EventBits
from rtron.vocabulary import EventFlow, WhenUnknown

MAX_AGE, PRESENT, SILENT = 10, 7, 13
KINDS = ({}, {"present": PRESENT}, {"silent": SILENT})
WAIT = "wait"
BLOCK, SET, CLEAR, KEEP = WhenUnknown
gaps = st.sampled_from([0, 0, 1, *(b + d for b in (MAX_AGE, PRESENT, SILENT) for d in (-1, 0, 1))])
happenings = st.lists(
    st.tuples(gaps, st.sampled_from([FOUND, FOUND, LOST, True, True, False, None, WAIT])),
    max_size=25,
)


def event(name="eflow", **others):
    return EventFlow(name=name, topic="/t", publisher="/p", **{"max_age": MAX_AGE, **others})


flows = st.builds(
    lambda kind, silence, error: event(**kind, on_silence=silence, on_error=error),
    st.sampled_from(KINDS),
    st.sampled_from(WhenUnknown),
    st.sampled_from(WhenUnknown),
)


def tell(bit, what, now):
    """Let a bit hear something."""
    if what == FOUND:
        bit.add_publisher()
    elif what == LOST:
        bit.remove_publisher()
    else:
        bit.observe(what, now)


def possible(steps):
    """Return the steps without those that lose a publisher who is not there."""
    links = 0
    for gap, what in steps:
        if what == LOST and not links:
            yield gap, WAIT
        else:
            links += (what == FOUND) - (what == LOST)
            yield gap, what


@often
@given(flows, happenings)
def test_a_bit_is_what_a_naive_model_says_at_every_moment(flow, steps):
    bits, model, now = EventBits([flow]), NaiveBit(flow), 0
    bit = bits.by_name["eflow"]
    for gap, what in possible(steps):
        for _ in range(gap):
            now += 1
            assert bit.value(now) is model.value(now)
        if what != WAIT:
            tell(bit, what, now)
            model.heard.append((now, what))
        assert bit.value(now) is model.value(now)
        value = model.value(now)
        assert bits.known_values(now) == ({} if value is None else {"eflow": value})


@often
@given(flows, happenings)
def test_a_bit_changes_at_no_other_time_than_it_says(flow, steps):
    """A look after each event and at each deadline finds what a look at every moment finds."""
    (seldom, always), now = (EventBits([flow]) for _ in range(2)), 0
    known = seldom.known_values(0)
    for gap, what in possible(steps):
        for _ in range(gap):
            due = seldom.deadline(now)
            now += 1
            known = seldom.known_values(now) if due == now else known
            assert always.known_values(now) == known
        if what != WAIT:
            for bits in (seldom, always):
                tell(bits.by_name["eflow"], what, now)
        known = seldom.known_values(now)
        assert always.known_values(now) == known


def values(steps, ages, **others):
    """Return the bit at each age after the last of (time, what)."""
    found = []
    for age in ages:
        bit = EventBits([event(**others)]).by_name["eflow"]
        for now, what in steps:
            tell(bit, what, now)
            bit.value(now)
        found.append(bit.value(now + age))
    return found


@pytest.mark.parametrize("judged", [True, False])
def test_the_newest_message_counts_for_max_age(judged):
    steps = [(0, FOUND), (5, judged)]
    assert values(steps, (0, MAX_AGE - 1, MAX_AGE)) == [judged, judged, None]
    assert values([(0, FOUND), (1, not judged), (2, judged)], (0,)) == [judged]


@pytest.mark.parametrize(("when", "known"), [(BLOCK, None), (SET, True), (CLEAR, False)])
def test_the_plan_says_what_silence_and_errors_count_as(when, known):
    assert values([(0, FOUND)], (0, 99), on_silence=when) == [known, known]
    assert values([(0, FOUND), (5, True)], (MAX_AGE,), on_silence=when) == [known]
    assert values([(0, FOUND), (5, None)], (0, MAX_AGE - 1), on_error=when) == [known, known]
    assert values([(0, FOUND)], (0,), on_error=when) == [None]


@pytest.mark.parametrize("judged", [True, False])
def test_keep_is_the_last_that_was_known(judged):
    steps = [(0, FOUND), (5, judged)]
    assert values(steps, (MAX_AGE, 10**9), on_silence=KEEP) == [judged, judged]
    assert values([*steps, (6, None)], (0,), on_error=KEEP) == [judged]
    assert values([*steps, (6, LOST)], (0,), on_silence=KEEP) == [judged]
    assert values([(0, FOUND)], (0,), on_silence=KEEP) == [None]


@pytest.mark.parametrize("judged", [True, False, None])
def test_when_the_publisher_is_gone_nobody_knows(judged):
    gone = [(0, FOUND), (5, judged), (6, LOST)]
    assert values(gone, (0,), on_error=SET) == [None]
    assert values([*gone, (7, FOUND)], (0,), on_error=SET) == [None]
    assert values([*gone, (7, FOUND), (7, False)], (0,)) == [False]


def test_one_of_two_connections_is_enough():
    both = [(0, FOUND), (0, FOUND), (5, True), (6, LOST)]
    assert values(both, (0,)) == [True]
    assert values([*both, (7, LOST)], (0,)) == [None]
    assert values(both, (0,), present=PRESENT) == [True]
    assert values([*both, (7, LOST)], (0,), present=PRESENT) == [None]


def test_presence_lasts_for_its_time_after_a_message_for_which_it_holds():
    there = [(0, FOUND), (5, True)]
    assert values(there, (0, PRESENT - 1, PRESENT), present=PRESENT) == [True, True, False]
    assert values([*there, (6, False)], (PRESENT - 2, PRESENT - 1), present=PRESENT) == [
        True,
        False,
    ]
    assert values([*there, (8, True)], (PRESENT - 1, PRESENT), present=PRESENT) == [True, False]
    assert values(there, (10**12,), present=PRESENT) == [False]


def test_nothing_is_present_while_a_publisher_says_nothing():
    assert values([(0, FOUND)], (0, 99), present=PRESENT) == [False, False]
    assert values([(0, FOUND), (0, False)], (0,), present=PRESENT) == [False]


def test_presence_is_unknown_without_a_publisher():
    assert values([(0, FOUND), (5, True), (6, LOST)], (0,), present=PRESENT) == [None]
    again = [(0, FOUND), (5, True), (6, LOST), (7, FOUND)]
    assert values(again, (0, PRESENT - 3, PRESENT - 2), present=PRESENT) == [True, True, False]


def test_a_presence_that_cannot_be_judged_is_unknown_until_it_can():
    broken = [(0, FOUND), (5, True), (6, None)]
    assert values(broken, (0, 99), present=PRESENT, on_error=SET) == [True, True]
    assert values(broken, (0,), present=PRESENT) == [None]
    assert values([*broken, (6, False)], (0, PRESENT - 2, PRESENT - 1), present=PRESENT) == [
        True,
        True,
        False,
    ]


def test_silence_counts_from_its_bound_and_before_the_first_message():
    assert values([(0, FOUND)], (0, 1), silent=SILENT) == [True, True]
    steps = [(0, FOUND), (5, True)]
    assert values(steps, (0, SILENT - 1, SILENT), silent=SILENT) == [False, False, True]


@pytest.mark.parametrize("what", [False, None, LOST])
def test_only_a_message_for_which_it_holds_ends_a_silence(what):
    assert values([(0, FOUND), (5, True), (6, what)], (SILENT - 2, SILENT - 1), silent=SILENT) == [
        False,
        True,
    ]
    assert values([(0, FOUND), (5, False)], (0,), silent=SILENT) == [True]


def test_silence_wins_where_a_flow_has_both():
    """A plan cannot say so; a bit that is 1 too often is the safe side."""
    assert values([(0, FOUND)], (0,), silent=SILENT, present=PRESENT) == [True]


@pytest.mark.parametrize("kind", KINDS)
def test_a_bit_knows_its_flow(kind):
    flow = event("a", **kind)
    assert EventBits([flow]).by_name["a"].flow is flow


def test_the_bits_that_are_known():
    bits = EventBits([event("a"), event("b", silent=SILENT), event("c", on_silence=CLEAR)])
    assert bits.known_values(0) == {"b": True, "c": False}
    bits.by_name["a"].observe(judged=False, now=0)
    assert bits.known_values(0) == {"a": False, "b": True, "c": False}
    assert EventBits().known_values(0) == {}


def test_the_deadline_is_the_next_change_to_come():
    bits = EventBits([event("a"), event("b", silent=SILENT), event("c", present=PRESENT)])
    assert bits.deadline(0) is None
    for name in "abc":
        bits.by_name[name].observe(judged=True, now=5)
    dues = {5 + MAX_AGE, 5 + SILENT, 5 + PRESENT}
    assert bits.deadline(5) == min(dues) == 12
    assert [bits.deadline(now) for now in (11, 12, 14, 15, 17, 18)] == [12, 15, 15, 18, 18, None]


@pytest.mark.parametrize(("kind", "what"), [*product(KINDS[1:], [False, None])])
def test_what_does_not_trigger_changes_nothing_later(kind, what):
    bits = EventBits([event(**kind)])
    bits.by_name["eflow"].observe(what, 5)
    assert bits.deadline(5) is None


@often
@given(flows, happenings)
def test_a_bit_that_takes_over_what_another_heard_is_the_same_at_every_moment(flow, steps):
    heard, taken = (EventBits([flow]).by_name["eflow"] for _ in range(2))
    now = 0
    for gap, what in possible(steps):
        now += gap
        if what != WAIT:
            tell(heard, what, now)
        assert taken.restore(heard.state) is (what is True)
        assert taken.value(now) is heard.value(now)
        assert taken.next_change() == heard.next_change()


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("counts_as", WhenUnknown)
def test_a_forgotten_bit_is_not_known_until_somebody_tells_again(kind, counts_as):
    bit = EventBits([event(**kind, on_silence=counts_as, on_error=counts_as)]).by_name["eflow"]
    bit.add_publisher()
    tell(bit, True, 5)  # noqa: FBT003 - what it hears
    known = bit.value(5)
    bit.forget()
    assert bit.value(5) is None
    bit.restore(bit.state)
    assert bit.value(5) is known

"""The rules of a mission: what holds, what is met, and who is told."""

from dataclasses import replace

import pytest
from event_and_rate_models import NaiveBit, NaiveRule
from hypothesis import given
from hypothesis import strategies as st
from policy_runs import often
from test_event_bits import WAIT, event, happenings, possible, tell

from rtron.messages.expressions.condition import Condition
from rtron.policies.mission.event_bits import EventBits, EventState
from rtron.policies.mission.rule_status import MissionMonitor
from rtron.vocabulary import MissionRule, WhenUnknown

NAMES = ("a", "b", "c")
EVENTS = (
    event("a", on_silence=WhenUnknown.CLEAR),
    event("b", present=7, on_error=WhenUnknown.KEEP),
    event("c", silent=13),
)


class Asked:
    """A condition that one bit decides; it counts how often it is asked."""

    def __init__(self, *names):
        self.names = names
        self.times = 0

    def holds(self, bits):
        self.times += 1
        return bits.get(self.names[0])


def rule(name="alarm", **others):
    return MissionRule(name=name, block=("/goal",), **others)


def mission(*conditions, events=EVENTS):
    """Return a mission with rules r0, r1, ... under these conditions."""
    named = [(rule(f"r{at}"), condition) for at, condition in enumerate(conditions)]
    return MissionMonitor(EventBits(events), named)


def written(text):
    return Condition(text, NAMES)


def say(mission, now, **judged):
    for name, each in judged.items():
        mission.observe(name, each, now)
    mission.update(now)


def one(condition=None, **others):
    """Return a mission with one rule about `a`, the rule, and the list of who is told."""
    made = MissionMonitor(EventBits([event("a")]), [(rule(**others), condition or Asked("a"))])
    told = []
    made.on_change = lambda standing: told.append((standing.rule.name, standing.is_blocking))
    return made, made.statuses["alarm"], told


# A condition, as Python knows it: unknown is None.


def naive_not(one):
    return None if one is None else not one


def naive_and(one, other):
    return False if one is False or other is False else None if None in (one, other) else True


def naive_or(one, other):
    return naive_not(naive_and(naive_not(one), naive_not(other)))


def negated(part):
    return f"!({part[0]})", lambda bits: naive_not(part[1](bits))


def joined(sign, operation):
    def join(one, other):
        text = f"({one[0]}) {sign} ({other[0]})"
        return text, lambda bits: operation(one[1](bits), other[1](bits))

    return join


def name_of(name):
    return name, lambda bits: bits.get(name)


conditions = st.recursive(
    st.sampled_from(NAMES).map(name_of)
    | st.sampled_from([("true", lambda bits: True), ("false", lambda bits: False)]),
    lambda parts: (
        st.builds(negated, parts)
        | st.builds(joined("&&", naive_and), parts, parts)
        | st.builds(joined("||", naive_or), parts, parts)
    ),
    max_leaves=6,
)
story = st.lists(
    st.tuples(st.sampled_from(NAMES), happenings.map(lambda steps: steps[:3])), max_size=8
)
meetings = st.lists(st.sampled_from([None, "r0", "r1"]), min_size=1, max_size=4)


def told_steps(story):
    """Yield (gap, name, what): what each event says, and never the loss of who is not there."""
    steps = {name: [] for name in NAMES}
    order = []
    for name, some in story:
        steps[name] += some
        order += [name] * len(some)
    ready = {name: possible(some) for name, some in steps.items()}
    for name in order:
        gap, what = next(ready[name])
        yield gap, name, what


@often
@given(st.lists(conditions, min_size=2, max_size=3), story, meetings)
def test_rules_are_what_a_naive_model_says_at_every_moment(conditions, story, meetings):
    made = mission(*(written(text) for text, _ in conditions))
    told = []
    made.on_change = lambda standing: told.append((standing.rule.name, standing.is_blocking))
    rules = {f"r{at}": NaiveRule(holds) for at, (_, holds) in enumerate(conditions)}
    bits = {flow.name: NaiveBit(flow) for flow in EVENTS}
    now, steps = 0, list(told_steps(story))

    def look():
        values = {name: bit.value(now) for name, bit in bits.items()}
        for each in rules.values():
            each.update({name: value for name, value in values.items() if value is not None})
        agree()

    def agree():
        blocks = {name: each.blocks() for name, each in rules.items()}
        assert {name: each.is_blocking for name, each in made.statuses.items()} == blocks
        expected = {name for name in blocks if blocks[name] is not before[name]}
        assert sorted(told) == sorted((name, blocks[name]) for name in expected)
        told.clear()
        before.update(blocks)

    before = dict.fromkeys(rules, True)
    for name, each in made.statuses.items():
        rules[name].update({})
        before[name] = each.is_blocking
    made.update(now)
    look()
    for number, (gap, name, what) in enumerate(steps):
        for _ in range(gap):
            now += 1
            made.update_if_due(now)
            look()
        if what != WAIT:
            tell(made.bits.by_name[name], what, now)
            bits[name].heard.append((now, what))
        made.update(now)
        look()
        if met := meetings[number % len(meetings)]:
            made.mark_met([met])
            rules[met].meet()
            agree()


@often
@given(conditions, story)
def test_looking_when_time_changes_a_bit_is_looking_at_every_moment(condition, story):
    """A whole recording: the moments at which the rule begins or ceases to block are the same."""
    always, seldom = mission(written(condition[0])), mission(written(condition[0]))
    told = {id(always): [], id(seldom): []}
    now = 0
    for made in (always, seldom):
        made.on_change = lambda status, made=made: told[id(made)].append((now, status.is_blocking))
        made.update(0)
    for gap, name, what in told_steps(story):
        end = now + gap
        while seldom.due is not None and seldom.due <= end:
            due = seldom.due
            while now < due:
                now += 1
                always.update(now)
            seldom.update_if_due(now)
        while now < end:
            now += 1
            always.update(now)
        for made in (always, seldom):
            if what != WAIT:
                tell(made.bits.by_name[name], what, now)
            made.update(now)
    assert told[id(seldom)] == told[id(always)]


def test_a_rule_holds_while_its_event_is_not_known():
    made, alarm, _ = one()
    assert (alarm.is_blocking, alarm.unknown_events) == (True, ("a",))
    assert alarm.reason == "rule alarm: while true (not known: a)"
    say(made, 0, a=True)
    assert (alarm.is_blocking, alarm.unknown_events) == (True, ())
    say(made, 1, a=False)
    assert (alarm.is_blocking, alarm.unknown_events) == (False, ())
    say(made, 2, a=None)
    assert (alarm.is_blocking, alarm.unknown_events) == (True, ("a",))


def test_a_rule_tells_its_reason():
    _, alarm, _ = one(written("a && !b"), when="a && !b", reason="the floor is wet")
    assert alarm.reason.startswith("rule alarm: the floor is wet (")
    made, alarm, _ = one(when="a")
    say(made, 0, a=True)
    assert alarm.reason == "rule alarm: while a"


def test_changes_are_told_exactly_when_a_rule_begins_or_ceases_to_block():
    made, _, told = one()
    for now, judged in enumerate([True, True, False, False, True, None, True, False]):
        say(made, now, a=judged)
    assert told == [("alarm", False), ("alarm", True), ("alarm", False)]


def test_time_alone_changes_a_rule():
    made, alarm, told = one()
    say(made, 5, a=False)
    assert made.due == 5 + 10
    made.update_if_due(14)
    assert not alarm.is_blocking
    made.update_if_due(15)
    assert alarm.is_blocking
    assert told == [("alarm", False), ("alarm", True)]
    assert made.due is None
    made.update_if_due(10**9)
    assert len(told) == 2


def test_an_obligation_blocks_until_it_is_met():
    made, alarm, told = one(require="/alert")
    say(made, 0, a=True)
    made.mark_met(["alarm"])
    assert (alarm.holds, alarm.is_met, alarm.is_blocking) == (True, True, False)
    made.mark_met(["alarm"])
    say(made, 1, a=True)
    assert told == [("alarm", False)]


@pytest.mark.parametrize(
    ("flow", "judged", "met"),
    [("b", True, True), ("b", False, False), ("b", None, False), ("a", True, False)],
)
def test_an_obligation_may_be_met_by_an_event(flow, judged, met):
    rules = [(rule(require="b"), Asked("a")), (rule("other", require="/alert"), Asked("a"))]
    made = MissionMonitor(EventBits([event("a"), event("b")]), rules)
    say(made, 0, a=True)
    told = []
    made.on_change = lambda standing: told.append(standing.rule.name)
    say(made, 1, **{flow: judged})
    alarm, other = made.statuses.values()
    assert (alarm.is_met, alarm.is_blocking, other.is_blocking) == (met, not met, True)
    assert told == (["alarm"] if met else [])
    value = made.bits.by_name[flow].value(1)
    assert value is judged


def test_an_event_meets_every_rule_that_requires_it():
    rules = [(rule(name, require="b"), Asked("a")) for name in ("alarm", "other")]
    made = MissionMonitor(EventBits([event("a"), event("b")]), rules)
    say(made, 0, a=True)
    say(made, 1, b=True)
    assert [standing.is_met for standing in made.statuses.values()] == [True, True]


def test_an_obligation_stays_met_while_it_stays_unknown():
    made = MissionMonitor(
        EventBits([event("a"), event("b")]), [(rule(require="/alert"), Asked("a", "b"))]
    )
    made.mark_met(["alarm"])
    say(made, 0, b=True)
    assert made.statuses["alarm"].is_met


def test_an_obligation_that_was_met_is_open_again_after_its_event_was_not_known():
    made, alarm, _ = one(require="/alert")
    say(made, 0, a=True)
    made.mark_met(["alarm"])
    say(made, 1, a=None)
    assert not alarm.is_blocking
    say(made, 2, a=True)
    assert alarm.is_blocking


def test_an_obligation_arises_again_with_its_condition():
    made, alarm, told = one(require="/alert")
    say(made, 0, a=True)
    made.mark_met(["alarm"])
    say(made, 1, a=False)
    assert not alarm.is_met
    say(made, 2, a=True)
    assert alarm.is_blocking
    assert told == [("alarm", False), ("alarm", True)]


def test_what_is_not_required_yet_meets_nothing():
    made, alarm, told = one(require="/alert")
    say(made, 0, a=False)
    made.mark_met(["alarm"])
    say(made, 1, a=True)
    assert alarm.is_blocking
    assert told == [("alarm", False), ("alarm", True)]


def test_an_obligation_that_was_met_while_nobody_knew_is_open_once_it_is_known():
    made, alarm, _ = one(require="/alert")
    made.mark_met(["alarm"])
    assert not alarm.is_blocking
    say(made, 0, a=True)
    assert alarm.is_blocking
    made.mark_met(["alarm"])
    assert not alarm.is_blocking


def test_only_the_rules_that_ask_for_a_changed_bit_are_looked_at():
    asked = [Asked("a"), Asked("a", "b"), Asked("b")]
    made = mission(*asked)
    made.update(0)
    before = [each.times for each in asked]
    say(made, 1, a=True)
    assert [each.times for each in asked] == [before[0] + 1, before[1] + 1, before[2]]
    say(made, 2, a=True)
    assert [each.times for each in asked] == [before[0] + 1, before[1] + 1, before[2]]


def test_a_rule_is_looked_at_once_however_many_of_its_bits_changed():
    asked = Asked("a", "b", "c")
    made = mission(asked)
    made.update(0)
    times = asked.times
    made.bits.by_name["b"].add_publisher()
    say(made, 1, a=True, b=True, c=True)
    assert asked.times == times + 1


@pytest.mark.parametrize(("text", "blocks"), [("true", True), ("false", False)])
def test_a_rule_without_events_is_settled_at_once(text, blocks):
    made, alarm, told = one(written(text))
    made.update(0)
    assert (alarm.is_blocking, alarm.unknown_events, told) == (blocks, (), [])


@pytest.mark.parametrize(
    ("others", "text", "blocks"),
    [
        ({"on_silence": WhenUnknown.CLEAR}, "a", False),
        ({"on_silence": WhenUnknown.SET}, "!a", False),
        ({"silent": 13}, "!a", False),
        ({"silent": 13}, "a", True),
        ({}, "a", True),
        ({}, "!a", True),
    ],
)
def test_what_is_known_without_a_message_counts_from_the_first_look(others, text, blocks):
    made = mission(written(text), events=[event("a", **others)])
    assert made.due == 0
    made.update_if_due(0)
    assert made.statuses["r0"].is_blocking is blocks
    assert made.due is None


def test_without_rules_nothing_happens():
    made = MissionMonitor(EventBits())
    made.update(0)
    made.update_if_due(1)
    made.mark_met(())
    assert (made.due, made.statuses) == (None, {})


def test_nobody_need_listen():
    made = MissionMonitor(EventBits([event("a")]), [(rule(), Asked("a"))])
    say(made, 0, a=False)
    assert not made.statuses["alarm"].is_blocking


def test_what_is_required_stays_owed_after_the_rule_ceases_to_hold():
    made, alarm, _ = one(require="/alert")
    say(made, 0, a=True)
    say(made, 1, a=False)
    assert (alarm.is_blocking, alarm.holds, alarm.is_pending) == (True, False, True)
    made.mark_met(["alarm"])
    assert (alarm.is_blocking, alarm.is_pending) == (False, False)


def test_where_nothing_is_required_nothing_is_owed():
    made, alarm, _ = one()
    say(made, 0, a=True)
    say(made, 1, a=False)
    assert (alarm.is_blocking, alarm.is_pending) == (False, False)


def test_it_is_owed_again_each_time_the_rule_begins_to_hold():
    made, alarm, _ = one(require="/alert")
    for now in (0, 2):
        say(made, now, a=True)
        assert alarm.is_blocking
        made.mark_met(["alarm"])
        say(made, now + 1, a=False)
        assert not alarm.is_blocking


def test_what_was_met_stays_met_while_the_rule_goes_on_to_hold():
    made, alarm, _ = one(written("a || b"), require="/alert")
    say(made, 0, a=True)
    made.mark_met(["alarm"])
    say(made, 1, a=True)
    assert not alarm.is_blocking


def test_what_nobody_knows_is_named_only_while_it_matters():
    made = MissionMonitor(EventBits(EVENTS), [(rule(), written("a && b"))])
    alarm = made.statuses["alarm"]
    assert alarm.unknown_events == ("a", "b")
    say(made, 0, a=False)
    assert alarm.unknown_events == ()
    say(made, 1, a=True)
    assert alarm.unknown_events == ("b",)


def test_an_event_of_the_topic_that_is_required_meets_it():
    call = replace(event("call"), topic="/phone")
    made = MissionMonitor(EventBits([event("a"), call]), [(rule(require="/phone"), Asked("a"))])
    alarm = made.statuses["alarm"]
    say(made, 0, a=True)
    say(made, 1, call=False)
    assert alarm.is_blocking
    say(made, 2, call=True)
    assert not alarm.is_blocking


@pytest.mark.parametrize("required", ["b", "/t"])
def test_an_obligation_may_be_met_by_an_event_that_another_process_has_heard(required):
    made, standing, _ = one(Asked("a"), require=required)
    made.restore("a", EventState(publishers=1, newest=1, judged=True, triggered=1, true_count=0))
    made.update(1)
    assert standing.is_blocking
    heard = EventState(publishers=1, newest=2, judged=True, triggered=2, true_count=1)
    made.restore("a", heard)
    assert standing.is_blocking is (required == "b")
    made.restore("a", heard)
    assert standing.is_blocking is (required == "b")

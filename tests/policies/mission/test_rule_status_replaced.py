"""Rules that change while a mission runs: what stays owed, what is freed, what holds at once."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from policy_runs import often
from test_event_bits import event
from test_rule_status import NAMES, rule, written

from rtron.policies.mission.event_bits import EventBits
from rtron.policies.mission.rule_status import MissionMonitor
from rtron.vocabulary import MissionRule

EVENTS = tuple(event(name) for name in NAMES)


class Changing:
    """A mission whose rules are given as (name, when, require), with all who were told."""

    def __init__(self, *rules):
        self.mission = MissionMonitor(EventBits(EVENTS), list(map(_compiled, rules)))
        self.mission.on_change = lambda standing: self.told.append(
            (standing.rule.name, standing.is_blocking)
        )
        self.told = []
        for bit in self.mission.bits.by_name.values():
            bit.add_publisher()
        self.now = 0

    def say(self, **judged):
        self.now += 1
        for name in NAMES:
            self.mission.observe(name, judged.get(name, False), self.now)
        self.mission.update(self.now)

    def put(self, *rules):
        self.told.clear()
        compiled = list(map(_compiled, rules))
        standings = self.mission.prepare_rules(compiled)
        before = self.blocking()
        assert self.blocking() == before
        self.mission.replace_rules(standings, compiled, self.now)
        return self.blocking()

    def blocking(self):
        return {name for name, each in self.mission.statuses.items() if each.is_blocking}


def _compiled(short):
    made = (
        short if isinstance(short, MissionRule) else rule(short[0], when=short[1], require=short[2])
    )
    return made, written(made.when)


def test_a_new_rule_starts_from_the_bits_that_are_known():
    run = Changing()
    run.say(a=True)
    assert run.put(("yes", "a", ""), ("no", "b", "")) == {"yes"}
    assert run.told == [("yes", True)]
    run.say(b=True)
    assert run.blocking() == {"no"}


def test_a_new_rule_whose_bits_nobody_knows_blocks():
    run = Changing()
    assert run.put(("yes", "a", "")) == {"yes"}
    assert "not known: a" in run.mission.statuses["yes"].reason


def test_what_is_gone_frees_what_it_blocked_and_comes_back_anew():
    run = Changing(("gone", "a", "/alert"))
    run.say(a=True)
    run.say()
    assert run.blocking() == {"gone"}
    assert run.put() == set()
    assert run.told == [("gone", False)]
    assert run.put(("gone", "a", "/alert")) == set()
    run.say(a=True)
    assert run.blocking() == {"gone"}


def test_what_is_gone_is_not_asked_any_more():
    run = Changing(("gone", "a", "b"))
    run.put()
    run.told.clear()
    run.say(a=True, b=True)
    assert run.told == []


def test_an_unchanged_rule_keeps_its_standing_and_what_is_owed():
    run = Changing(("stays", "a", "/alert"), ("goes", "b", ""))
    run.say(a=True)
    run.say()
    standing = run.mission.statuses["stays"]
    assert run.put(("stays", "a", "/alert"), ("comes", "c", "")) == {"stays"}
    assert run.told == []
    assert run.mission.statuses["stays"] is standing
    run.mission.mark_met(["stays"])
    assert run.blocking() == set()


def test_an_unchanged_rule_that_was_met_stays_met():
    run = Changing(("stays", "a", "/alert"))
    run.say(a=True)
    run.mission.mark_met(["stays"])
    assert run.put(("stays", "a", "/alert")) == set()
    assert run.put(replace(rule("stays", when="a", require="/alert"), block=("/other",))) == set()
    assert run.mission.statuses["stays"].rule.block == ("/other",)


def test_another_condition_is_looked_at_at_once():
    run = Changing(("one", "a", ""))
    run.say(b=True)
    assert run.put(("one", "b", "")) == {"one"}
    assert run.told == [("one", True)]
    assert run.put(("one", "a && b", "")) == set()
    run.say(a=True, b=True)
    assert run.blocking() == {"one"}
    run.say(a=True)
    assert run.blocking() == set()


@pytest.mark.parametrize("when", ["a", "b"])
def test_what_is_owed_outlasts_another_condition_but_not_another_obligation(when):
    run = Changing(("one", "a", "/alert"))
    run.say(a=True)
    run.say()
    assert run.put(("one", when, "/alert")) == {"one"}
    assert run.put(("one", when, "/other")) == set()


def test_another_condition_that_holds_asks_again_for_what_was_met():
    run = Changing(("one", "a", "/alert"))
    run.say(a=True, b=True)
    run.mission.mark_met(["one"])
    assert run.put(("one", "b", "/alert")) == {"one"}
    run.mission.mark_met(["one"])
    assert run.blocking() == set()


def test_an_event_meets_what_a_new_rule_requires():
    run = Changing()
    run.say(a=True)
    assert run.put(("one", "a", "b")) == {"one"}
    run.say(a=True, b=True)
    assert run.blocking() == set()


def test_time_that_has_passed_counts_before_the_rules_change():
    run = Changing(("one", "a", ""))
    run.say()
    run.now += EVENTS[0].max_age
    assert run.put(("one", "!a", "")) == {"one"}
    assert run.mission.statuses["one"].unknown_events == ("a",)


conditions = st.sampled_from(["a", "b", "a && !b", "a || c", "!c"])
rules = st.dictionaries(st.sampled_from(["r", "s"]), conditions)


@often
@given(rules, st.lists(st.sets(st.sampled_from(NAMES)) | rules, max_size=15))
def test_rules_without_obligations_hold_as_if_they_had_always_been_there(first, steps):
    run = Changing(*((name, when, "") for name, when in first.items()))
    said, current = None, first
    for step in steps:
        if isinstance(step, dict):
            current = step
            run.put(*((name, when, "") for name, when in step.items()))
        else:
            said = step
            run.say(**dict.fromkeys(step, True))
        fresh = Changing(*((name, when, "") for name, when in current.items()))
        if said is not None:
            fresh.say(**dict.fromkeys(said, True))
        assert run.blocking() == fresh.blocking()

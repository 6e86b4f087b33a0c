"""The lease of a group: its answers at their bounds, and in every sequence of requests."""

from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st
from policy_runs import often

from rtron.policies.authority.command_lease import Commander, CommandLease, Person
from rtron.vocabulary import SECOND, CommanderRank

TTL = 10
RANKS = tuple(CommanderRank)
SITE, REMOTE, OTHER_REMOTE, NAV, AGENT = "/site", "/remote", "/other", "/nav", "/agent"
BUTTON, STRANGER = "/button", "/stranger"
COMMANDERS = (
    Commander(BUTTON, CommanderRank.EMERGENCY),
    Commander(SITE, CommanderRank.OPERATOR_ON_SITE),
    Commander(REMOTE, CommanderRank.REMOTE_OPERATOR),
    Commander(OTHER_REMOTE, CommanderRank.REMOTE_OPERATOR),
    Commander(NAV, CommanderRank.AUTONOMY),
    Commander(AGENT, CommanderRank.AGENT),
)
RANK = {each.name: RANKS.index(each.rank) for each in COMMANDERS}
NAMES = (*RANK, STRANGER)
EVA = Person("eva", None)
ANN, BOB = (Person(name, CommanderRank.REMOTE_OPERATOR) for name in ("ann", "bob"))


def lease(ttl=TTL):
    return CommandLease("base", COMMANDERS, ttl)


def holder(lease, now):
    grant = lease.grant(now)
    return grant.holder.name if grant else None


def test_at_first_nobody_holds_it():
    base = lease()
    assert base.grant(0) is None
    assert base.deadline(0) is None
    assert base.status(0) == base.holder_text(0) == "nobody holds base"


def test_the_first_to_ask_has_it_and_the_answer_says_so():
    base = lease(5 * SECOND)
    answer = base.acquire(NAV, 0, "a goal has come")
    assert answer.granted
    assert answer.reason == (
        "base is granted to /nav (autonomy) for 5.00 s, acquired: a goal has come; "
        "it moves nothing before a neutral command"
    )
    assert base.status(2 * SECOND) == (
        "/nav (autonomy) holds base for 2.00 s, acquired: a goal has come"
    )
    assert base.holder_text(2 * SECOND) == "/nav (autonomy) holds base"


@pytest.mark.parametrize(("after", "there"), [(0, True), (TTL - 1, True), (TTL, False)])
def test_it_ends_by_itself(after, there):
    base = lease()
    base.acquire(NAV, 3)
    assert base.deadline(3) == 3 + TTL
    assert (base.grant(3 + after) is not None) is there
    assert base.renew(NAV, 3 + after).granted is there


def test_who_held_it_last_is_told():
    base = lease()
    base.acquire(NAV, 0)
    assert base.status(TTL) == "nobody holds base; /nav (autonomy) held it last"


@pytest.mark.parametrize("again", ["renew", "acquire", "take_over"])
def test_the_holder_renews_it_however_it_asks(again):
    base = lease()
    base.acquire(NAV, 0)
    grant = base.grant(0)
    assert getattr(base, again)(NAV, TTL - 1).granted
    assert base.grant(TTL) is grant
    assert base.deadline(TTL) == TTL - 1 + TTL
    assert base.grant(2 * TTL - 1) is None


@pytest.mark.parametrize("verb", ["renew", "release"])
def test_only_the_holder_renews_and_releases(verb):
    base = lease()
    base.acquire(NAV, 0)
    answer = getattr(base, verb)(REMOTE, 1)
    assert not answer.granted
    assert answer.reason.startswith("/remote does not hold base: /nav (autonomy) holds base for")
    assert holder(base, 1) == NAV


def test_after_a_release_anybody_may_ask():
    base = lease()
    base.acquire(REMOTE, 0)
    grant = base.grant(0)
    answer = base.release(REMOTE, 4, "lunch")
    assert answer.granted
    assert answer.reason == "base is released by /remote (remote_operator): lunch"
    assert not grant.holds(4)
    assert grant.holds(3)
    assert base.acquire(AGENT, 4).granted


@pytest.mark.parametrize("verb", ["acquire", "renew", "release", "accept", "take_over"])
@pytest.mark.parametrize("held", [False, True])
def test_a_stranger_is_refused_everything(verb, held):
    base = lease()
    if held:
        base.acquire(NAV, 0)
        base.offer(NAV, STRANGER, 0)
    answer = getattr(base, verb)(STRANGER, 1)
    assert not answer.granted
    assert answer.reason == "/stranger is no commander of base: the plan does not name it"
    assert holder(base, 1) == (NAV if held else None)


def test_a_stranger_offers_nothing():
    answer = lease().offer(STRANGER, NAV, 0)
    assert not answer.granted
    assert "no commander" in answer.reason


@pytest.mark.parametrize("who", RANK)
@pytest.mark.parametrize("before", RANK)
def test_rank_alone_decides_who_takes_over(who, before):
    base = lease()
    base.acquire(before, 0)
    old = base.grant(0)
    answer = base.take_over(who, 1, "now")
    assert holder(base, 1) == (who if RANK[who] < RANK[before] or who == before else before)
    if who == before:
        assert base.grant(1) is old
    elif RANK[who] < RANK[before]:
        assert answer.granted
        assert not old.holds(1)
        assert f"taken over from {old.holder}: now" in answer.reason
    else:
        assert not answer.granted
        assert "has no higher rank" in answer.reason


def test_what_is_free_is_not_taken_but_acquired():
    base = lease()
    assert base.take_over(AGENT, 0, "free").granted
    assert base.grant(0).reason == "acquired: free"


@pytest.mark.parametrize(
    ("who", "hint"), [(SITE, "take it over"), (AGENT, "ask for it to be offered")]
)
def test_who_may_not_acquire_it_is_told_what_would_help(who, hint):
    base = lease()
    base.acquire(REMOTE, 0)
    answer = base.acquire(who, 1)
    assert not answer.granted
    assert answer.reason.endswith(f"acquired: {hint}")


def test_it_is_handed_over_with_both_sides_consent():
    base = lease()
    base.acquire(REMOTE, 0)
    old = base.grant(0)
    assert not base.accept(AGENT, 1).granted
    assert base.offer(REMOTE, AGENT, 2).granted
    assert holder(base, 2) == REMOTE
    assert base.accept(AGENT, 3).granted
    assert holder(base, 3) == AGENT
    assert not old.holds(3)
    assert base.grant(3).reason == "handed over by /remote (remote_operator)"
    assert base.deadline(3) == 3 + TTL


def test_an_offer_is_for_one_commander():
    base = lease()
    base.acquire(REMOTE, 0)
    base.offer(REMOTE, AGENT, 0)
    answer = base.accept(NAV, 1)
    assert not answer.granted
    assert answer.reason.startswith("nobody offers base to /nav (autonomy); /remote")
    base.offer(REMOTE, NAV, 1)
    assert not base.accept(AGENT, 2).granted
    assert base.accept(NAV, 2).granted


@pytest.mark.parametrize("to", [REMOTE, STRANGER, ""])
def test_it_is_offered_to_another_commander_alone(to):
    base = lease()
    base.acquire(REMOTE, 0)
    assert not base.offer(REMOTE, to, 0).granted
    assert not base.accept(to, 0).granted
    assert holder(base, 0) == REMOTE


@pytest.mark.parametrize(("after", "there"), [(TTL - 1, True), (TTL, False), (TTL + 1, False)])
def test_an_offer_ends_by_itself(after, there):
    base = lease()
    base.acquire(REMOTE, 0)
    base.offer(REMOTE, AGENT, 0)
    base.renew(REMOTE, TTL - 1)
    assert base.accept(AGENT, after).granted is there


def test_an_offer_ends_with_a_release():
    base = lease()
    base.acquire(REMOTE, 0)
    base.offer(REMOTE, AGENT, 0)
    base.release(REMOTE, 1)
    assert not base.accept(AGENT, 1).granted
    base.acquire(REMOTE, 1)
    assert not base.accept(AGENT, 1).granted


def test_an_offer_is_not_that_of_the_next_holder():
    base = lease()
    base.acquire(REMOTE, 0)
    base.offer(REMOTE, AGENT, 5)
    assert base.acquire(NAV, TTL).granted
    assert not base.accept(AGENT, TTL).granted


def test_neutral_can_be_required_again_of_the_holder():
    base = lease()
    base.require_neutral(0)
    assert base.grant(0) is None
    base.acquire(REMOTE, 1, "to park")
    old = base.grant(1)
    base.require_neutral(4)
    new = base.grant(4)
    assert not old.holds(4)
    assert new.holder == old.holder
    assert new.number > old.number
    assert (new.since, new.expires_at, new.reason) == (1, 1 + TTL, "acquired: to park")


@dataclass
class NaiveLease:
    """Who holds it until when, and to whom it is offered until when."""

    holder: str | None = None
    until: int = 0
    offered: str | None = None
    offered_until: int = 0

    def ask(self, verb, who, to, now):
        if self.holder and now >= self.until:
            self.holder = self.offered = None
        known = who in RANK
        if verb == "offer":
            granted = self.holder == who and to in RANK and to != who
            if granted:
                self.offered, self.offered_until = to, now + TTL
            return granted
        if verb in ("acquire", "renew", "take_over") and self.holder == who:
            self.until = now + TTL
            return True
        if verb == "release" and self.holder == who:
            self.holder = self.offered = None
            return True
        offered = self.holder and self.offered == who and now < self.offered_until
        above = self.holder and known and RANK[who] < RANK[self.holder]
        free = known and self.holder is None
        granted = {"acquire": free, "take_over": free or above, "accept": offered}.get(verb, False)
        if granted:
            self.holder, self.until, self.offered = who, now + TTL, None
        return bool(granted)


VERBS = ("acquire", "renew", "release", "offer", "accept", "take_over")
requests = st.lists(
    st.tuples(
        st.sampled_from([0, 0, 1, 1, TTL - 1, TTL, TTL + 1]),
        st.sampled_from(VERBS),
        st.sampled_from(NAMES),
        st.sampled_from(NAMES),
    ),
    min_size=8,
    max_size=60,
)


def played(requests):
    """Yield what each request did: the lease, the time, the request, before, answer, after."""
    base, now = lease(), 0
    for gap, verb, who, to in requests:
        now += gap
        before = base.grant(now)
        act = getattr(base, verb)
        answer = act(who, to, now) if verb == "offer" else act(who, now)
        yield base, now, (verb, who, to), before, answer, base.grant(now)


@often
@given(requests)
def test_it_does_what_a_naive_model_does(requests):
    model = NaiveLease()
    for base, now, (verb, who, to), _, answer, _ in played(requests):
        assert answer.granted is model.ask(verb, who, to, now)
        assert holder(base, now) == model.holder
        assert base.deadline(now) == (model.until if model.holder else None)


@often
@given(requests)
def test_of_all_grants_one_at_most_ever_holds(requests):
    grants = []
    for _, now, _, before, _, after in played(requests):
        grants += [each for each in (before, after) if each and each not in grants]
        holding = [each for each in grants if each.holds(now)]
        assert holding == ([after] if after else [])
    numbers = [each.number for each in grants]
    assert numbers == sorted(set(numbers))


@often
@given(requests)
def test_against_its_will_only_a_lower_rank_loses_it(requests):
    for _, now, (verb, who, _), before, _, after in played(requests):
        if before and not before.holds(now) and who != before.holder.name and verb != "accept":
            assert verb == "take_over"
            assert RANK[who] < RANK[before.holder.name]
            assert after.holder.name == who


@often
@given(requests)
def test_a_refusal_changes_nothing(requests):
    for _, now, _, before, answer, after in played(requests):
        if not answer.granted:
            assert after is before
            assert before is None or before.holds(now)


@often
@given(requests)
def test_every_answer_says_why_and_names_the_lease(requests):
    for _, _, _, _, answer, _ in played(requests):
        assert "base" in answer.reason


@often
@given(requests)
def test_nobody_holds_it_longer_than_the_time_without_a_request(requests):
    for base, now, _, _, _, after in played(requests):
        if after:
            assert now < after.expires_at <= now + TTL
            assert base.status(now).startswith(f"{after.holder} holds base for")


def test_a_person_beside_the_robot_gives_it_to_any_commander():
    base = lease()
    base.acquire(SITE, 0, "")
    before = base.grant(0)
    answer = base.give(AGENT, EVA, 1, "a trial")
    assert (answer.granted, holder(base, 1), before.holds(1)) == (True, AGENT, False)
    assert answer.reason.startswith("base is granted to /agent (agent)")
    assert "given by eva: a trial" in answer.reason


def test_a_person_gives_it_to_no_stranger():
    base = lease()
    base.acquire(SITE, 0, "")
    answer = base.give(STRANGER, EVA, 1, "")
    assert (answer.granted, holder(base, 1)) == (False, SITE)
    assert answer.reason == "/stranger is no commander of base: the plan does not name it"


def test_it_is_given_while_nobody_holds_it():
    base = lease()
    assert base.give(NAV, EVA, 0, "").granted
    assert holder(base, 0) == NAV


def test_a_person_beside_the_robot_ends_it():
    base = lease()
    base.acquire(SITE, 0, "")
    answer = base.end(EVA, 1, "lunch")
    assert (answer.granted, holder(base, 1)) == (True, None)
    assert answer.reason == "base is taken from /site (operator_on_site) by eva: lunch"


def test_what_nobody_holds_cannot_be_ended():
    answer = lease().end(EVA, 0, "")
    assert (answer.granted, answer.reason) == (False, "nobody holds base")


@pytest.mark.parametrize("to", [BUTTON, SITE])
def test_a_person_with_a_rank_gives_it_to_nobody_above_that(to):
    base = lease()
    answer = base.give(to, ANN, 0, "a trial")
    assert (answer.granted, base.grant(0)) == (False, None)
    assert answer.reason == f"{to} ({COMMANDERS[RANK[to]].rank}) has a higher rank than {ANN}"


@pytest.mark.parametrize("by", [SITE, REMOTE])
def test_a_person_takes_it_from_nobody_of_the_same_rank_or_above(by):
    base = lease()
    base.acquire(by, 0, "mine")
    for answer in (base.give(NAV, ANN, 1, "a trial"), base.end(ANN, 1, "a trial")):
        assert (answer.granted, holder(base, 1)) == (False, by)
        assert answer.reason.endswith("acquired: mine: ann (remote_operator) has no higher rank")


def test_a_person_takes_it_from_a_lower_rank_for_a_commander_or_for_nobody():
    base = lease()
    base.acquire(NAV, 0, "a goal")
    answer = base.give(REMOTE, ANN, 1, "a person is near")
    assert (answer.granted, holder(base, 1)) == (True, REMOTE)
    assert base.grant(1).reason == "given by ann (remote_operator): a person is near"
    base.release(REMOTE, 2)
    base.acquire(NAV, 2)
    assert base.end(ANN, 3, "lunch").granted
    assert holder(base, 3) is None


def test_what_a_person_has_given_that_person_alone_renews_hands_over_and_ends():
    base = lease()
    base.give(REMOTE, ANN, 0, "a trial")
    refused = base.renew_given(BOB, 1)
    assert (refused.granted, base.deadline(1)) == (False, TTL)
    assert refused.reason.startswith("bob (remote_operator) has not given base: /remote")
    assert not base.end(BOB, 1, "mine").granted
    assert not base.give(OTHER_REMOTE, BOB, 1, "mine").granted
    assert base.renew_given(ANN, 1).granted
    assert base.deadline(1) == 1 + TTL
    assert base.give(OTHER_REMOTE, ANN, 2, "another stick").granted
    assert base.end(ANN, 3, "done").granted


def test_what_has_ended_is_not_renewed_by_who_has_given_it():
    base = lease()
    base.give(NAV, ANN, 0, "a trial")
    assert not base.renew_given(ANN, TTL).granted
    base.acquire(NAV, TTL)
    assert not base.renew_given(ANN, TTL).granted


def test_a_stop_in_between_leaves_it_to_who_has_given_it():
    base = lease()
    base.give(REMOTE, ANN, 0, "a trial")
    base.require_neutral(1)
    assert base.renew_given(ANN, 1).granted


def test_who_has_the_same_name_beside_the_robot_is_somebody_else():
    base = lease()
    base.give(REMOTE, Person("ann", None), 0, "by hand")
    assert not base.end(ANN, 1, "mine").granted
    assert base.end(EVA, 1, "").granted


def test_it_names_its_commanders():
    assert lease().commander_names == tuple(RANK)

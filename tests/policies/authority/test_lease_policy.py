"""Lease as the policy of a stream: who passes, and what it says to all others."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from policy_runs import often, settings, watch_effects

from rtron.policies import build_policy
from rtron.policies.authority.command_lease import Commander, CommandLease
from rtron.policies.state_machine import TransitionEffect
from rtron.policies.state_transfer import PolicyState
from rtron.vocabulary import CommanderRank, Decision, Flow, PolicyName

TTL = 10
STAND, DRIVE = "stand", "drive"
SITE, NAV, BLOCKED, STRANGER = "site", "nav", "blocked", "stranger"
FLOWS = (
    Flow(name=SITE, publisher="/site"),
    Flow(name=NAV, publisher="/nav"),
    Flow(name=BLOCKED, publisher="/blocked", block=True),
)
COMMANDERS = (
    Commander("/site", CommanderRank.OPERATOR_ON_SITE),
    Commander("/nav", CommanderRank.AUTONOMY),
    Commander("/blocked", CommanderRank.EMERGENCY),
    Commander("/arm_only", CommanderRank.REMOTE_OPERATOR),
)
SETTINGS = settings(PolicyName.LEASE, flows=FLOWS, lease="base", revision=7)
PASS, DROP = Decision.PASS, Decision.DROP
HOLDS, FREE = "/nav (autonomy) holds base", "nobody holds base"
MUST = "/nav (autonomy) must send a neutral command first"


def new_lease():
    return CommandLease("base", COMMANDERS, TTL)


def policy_of(lease, chosen=SETTINGS):
    policy = build_policy(chosen, leases={"base": lease})
    policy.is_neutral = lambda message: message == STAND
    return policy


@pytest.fixture
def lease():
    return new_lease()


@pytest.fixture
def policy(lease):
    return policy_of(lease)


@pytest.mark.parametrize("message", [STAND, DRIVE])
@pytest.mark.parametrize("flow", [SITE, NAV])
def test_while_nobody_holds_it_nobody_passes(policy, flow, message):
    verdict = policy.verdict(flow, message, 0)
    assert (verdict.decision, verdict.reason, verdict.revision) == (DROP, FREE, 7)
    assert policy.owner is None
    assert policy.deadline() is None


def test_without_a_lease_nobody_passes():
    policy = build_policy(SETTINGS)
    policy.is_neutral = lambda _: True
    assert policy.verdict(NAV, STAND, 0).decision is DROP


def test_the_holder_passes_from_its_first_neutral_command_on(lease, policy):
    lease.acquire("/nav", 0)
    run = [DRIVE, DRIVE, STAND, DRIVE, STAND, DRIVE]
    verdicts = [policy.verdict(NAV, message, 1) for message in run]
    assert [v.decision for v in verdicts] == [DROP, DROP, PASS, PASS, PASS, PASS]
    assert [v.reason for v in verdicts] == [MUST, MUST, HOLDS, HOLDS, HOLDS, HOLDS]
    assert verdicts[2] is verdicts[3], "a pass builds no verdict"
    assert policy.owner == NAV


def test_as_long_as_nobody_knows_what_is_neutral_nothing_passes(lease):
    policy = build_policy(SETTINGS, leases={"base": lease})
    lease.acquire("/nav", 0)
    assert policy.verdict(NAV, STAND, 0).reason == MUST


def test_the_others_are_told_who_holds_it(lease, policy):
    lease.acquire("/nav", 0)
    policy.verdict(NAV, STAND, 0)
    assert policy.verdict(SITE, STAND, 0).reason == HOLDS
    assert policy.verdict(NAV, DRIVE, 0).decision is PASS


@pytest.mark.parametrize("flow", [BLOCKED, STRANGER])
def test_blocked_and_unknown_flows_are_dropped(lease, policy, flow):
    lease.acquire("/blocked", 0)
    assert policy.verdict(flow, STAND, 0).decision is DROP
    assert "blocked" in policy.verdict(flow, STAND, 0).reason or flow == STRANGER
    assert policy.owner is None


def test_who_holds_it_for_other_streams_owns_nothing_here(lease, policy):
    lease.acquire("/arm_only", 0)
    assert policy.verdict(NAV, STAND, 0).reason == "/arm_only (remote_operator) holds base"
    assert policy.owner is None


@pytest.mark.parametrize(("after", "decision"), [(TTL - 1, PASS), (TTL, DROP), (TTL + 1, DROP)])
def test_an_expired_lease_passes_nothing_even_without_a_tick(lease, policy, after, decision):
    lease.acquire("/nav", 3)
    policy.verdict(NAV, STAND, 3)
    assert policy.verdict(NAV, DRIVE, 3 + after).decision is decision


def test_a_renewed_lease_goes_on_without_another_neutral_command(lease, policy):
    lease.acquire("/nav", 0)
    policy.verdict(NAV, STAND, 0)
    lease.renew("/nav", TTL - 1)
    assert policy.verdict(NAV, DRIVE, TTL).decision is PASS
    assert policy.deadline() == 2 * TTL - 1


@pytest.mark.parametrize("lost", ["expired", "released", "taken", "required"])
def test_whoever_gets_it_again_must_be_neutral_again(lease, policy, lost):
    lease.acquire("/nav", 0)
    policy.verdict(NAV, STAND, 0)
    if lost == "released":
        lease.release("/nav", TTL)
    elif lost == "taken":
        lease.take_over("/site", TTL - 2)
        lease.release("/site", TTL - 1)
    elif lost == "required":
        lease.renew("/nav", TTL - 1)
        lease.require_neutral(TTL - 1)
    lease.acquire("/nav", TTL)
    assert policy.verdict(NAV, DRIVE, TTL).reason == MUST
    assert policy.verdict(NAV, STAND, TTL).decision is PASS


def test_the_refusal_of_who_has_lost_it_stops_the_robot_without_a_message(lease, policy):
    lease.acquire("/nav", 0)
    policy.verdict(NAV, STAND, 0)
    assert policy.refusal(NAV, 0) is None
    lease.take_over("/site", 1)
    assert policy.refusal(NAV, 1).reason == "/site (operator_on_site) holds base"
    lease.release("/site", 2)
    lease.acquire("/nav", 2)
    assert policy.refusal(NAV, 2).reason == MUST
    assert policy.refusal(NAV, 2, DRIVE).reason == MUST
    assert policy.refusal(NAV, 2, STAND) is None


def test_a_holder_whose_publisher_was_gone_must_be_neutral_again(lease, policy):
    lease.acquire("/nav", 0)
    policy.verdict(NAV, STAND, 0)
    policy.forget_flow(SITE, 1)
    assert policy.verdict(NAV, DRIVE, 1).decision is PASS
    policy.forget_flow(NAV, 2)
    policy.forget_flow(NAV, 2)
    assert policy.verdict(NAV, DRIVE, 2).reason == MUST


def test_a_change_of_hands_is_due_at_once(lease, policy):
    policy.tick(0)
    assert policy.deadline() is None
    lease.acquire("/nav", 5)
    assert policy.deadline() <= 5
    policy.tick(5)
    assert (policy.deadline(), policy.owner) == (5 + TTL, NAV)
    lease.take_over("/site", 6)
    assert policy.deadline() <= 6
    policy.tick(6)
    assert (policy.deadline(), policy.owner) == (6 + TTL, SITE)
    policy.tick(6 + TTL)
    assert (policy.deadline(), policy.owner) == (None, None)


def test_streams_of_one_group_have_one_holder_and_each_its_neutral(lease):
    base, arm = policy_of(lease), policy_of(lease)
    lease.acquire("/nav", 0)
    base.verdict(NAV, STAND, 0)
    assert base.verdict(NAV, DRIVE, 0).decision is PASS
    assert arm.verdict(NAV, DRIVE, 0).reason == MUST
    assert arm.verdict(SITE, DRIVE, 0).reason == HOLDS


def test_other_settings_leave_the_holder_in_command(lease, policy):
    lease.acquire("/nav", 0)
    policy.verdict(NAV, STAND, 0)
    after = policy_of(lease, replace(SETTINGS, revision=8))
    assert after.restore_state(policy.export_state(1), 1) == []
    verdict = after.verdict(NAV, DRIVE, 1)
    assert (verdict.decision, verdict.revision) == (PASS, 8)


@pytest.mark.parametrize("lost", ["expired", "taken"])
def test_other_settings_bring_no_command_back(lease, policy, lost):
    lease.acquire("/nav", 0)
    policy.verdict(NAV, STAND, 0)
    state = policy.export_state(1)
    if lost == "taken":
        lease.take_over("/site", 1)
        lease.release("/site", 1)
    lease.acquire("/nav", TTL)
    after = policy_of(lease)
    after.restore_state(state, TTL)
    assert after.verdict(NAV, DRIVE, TTL).reason == MUST


def test_a_policy_before_that_knows_no_lease_hands_on_no_command(lease, policy):
    lease.acquire("/nav", 0)
    policy.restore_state(PolicyState(last_message_times={NAV: 0}), 0)
    assert policy.verdict(NAV, DRIVE, 0).reason == MUST
    assert policy.export_state(0).neutral_grant is None


def test_verdicts_are_by_the_settings_in_force(lease, policy):
    lease.acquire("/nav", 0)
    policy.verdict(NAV, STAND, 0)
    policy.revise(9)
    messages = [(NAV, DRIVE), (SITE, DRIVE), (BLOCKED, DRIVE)]
    assert {policy.verdict(*each, 1).revision for each in messages} == {9}


def test_a_program_error_arms_nobody(policy):
    with pytest.raises(AssertionError, match="without a grant"):
        policy._arm(NAV)


NAMES = ("/site", "/nav", "/blocked", "/arm_only", "/stranger")
happenings = st.one_of(
    st.tuples(
        st.sampled_from(["acquire", "renew", "release", "take_over"]), st.sampled_from(NAMES)
    ),
    st.tuples(
        st.just("say"), st.sampled_from([(f, m) for f in (SITE, NAV) for m in (STAND, DRIVE)])
    ),
    st.tuples(st.just("say"), st.sampled_from([(BLOCKED, STAND), (STRANGER, STAND)])),
    st.tuples(st.just("forget"), st.sampled_from([SITE, NAV])),
    st.tuples(st.sampled_from(["tick", "require_neutral", "swap"]), st.none()),
)
runs = st.lists(
    st.tuples(st.sampled_from([0, 0, 0, 1, TTL - 1, TTL]), happenings), min_size=10, max_size=60
)


def played(run):
    """Yield lease, policy, time, what happened, and the verdict if a message came."""
    lease, now = new_lease(), 0
    policy = policy_of(lease)
    for gap, (what, of) in run:
        now += gap
        verdict = None
        if what == "say":
            verdict = policy.verdict(*of, now)
        elif what == "forget":
            policy.forget_flow(of, now)
        elif what == "tick":
            policy.tick(now)
        elif what == "require_neutral":
            lease.require_neutral(now)
        elif what == "swap":
            before, policy = policy, policy_of(lease)
            policy.restore_state(before.export_state(now), now)
        else:
            getattr(lease, what)(of, now)
        yield lease, policy, now, (what, of), verdict


@often
@given(runs)
def test_only_a_holder_that_was_neutral_under_its_grant_moves_anything(run):
    neutral = set()
    for lease, _, now, (what, of), verdict in played(run):
        grant = lease.grant(now)
        if what == "forget":
            neutral = {pair for pair in neutral if pair[1] != of}
        if what != "say":
            continue
        flow, message = of
        holds = grant is not None and grant.holder.name == f"/{flow}" and flow in (SITE, NAV)
        if holds and message == STAND:
            neutral.add((grant.number, flow))
        may_pass = holds and (grant.number, flow) in neutral
        assert (verdict.decision is PASS) is may_pass
        assert verdict.reason
        assert verdict.policy is PolicyName.LEASE


@often
@given(runs, st.sampled_from([SITE, NAV, BLOCKED, STRANGER]), st.sampled_from([STAND, DRIVE]))
def test_a_refusal_is_what_the_message_is_dropped_with(run, flow, message):
    for _, policy, now, _, _ in played(run):
        refusal = policy.refusal(flow, now, message)
        last = policy, now, refusal
    policy, now, refusal = last
    verdict = policy.verdict(flow, message, now)
    assert (refusal is None) is (verdict.decision is PASS)
    assert refusal is None or refusal == verdict


@often
@given(runs)
def test_a_tick_finds_the_owner_and_leaves_nothing_due(run):
    for lease, policy, now, _, _ in played(run):
        assert policy.tick(now) == ()
        grant = lease.grant(now)
        holder = grant.holder.name.strip("/") if grant else None
        assert policy.owner == (holder if holder in (SITE, NAV) else None)
        assert policy.deadline() == (grant.expires_at if grant else None)
        assert (policy._machine.state.name == "FREE") is (policy.owner is None)


@often
@given(runs)
def test_what_is_done_is_the_effect_in_the_table(run):
    lease, now = new_lease(), 0
    policy = policy_of(lease)
    effects = watch_effects(policy)
    for gap, (what, of) in run:
        now += gap
        if what == "say":
            effects.clear()
            verdict = policy.verdict(*of, now)
            assert effects[-1] is TransitionEffect[verdict.decision.name]
            assert set(effects[:-1]) <= {TransitionEffect.NOTHING}
        elif what in ("acquire", "renew", "release", "take_over"):
            getattr(lease, what)(of, now)

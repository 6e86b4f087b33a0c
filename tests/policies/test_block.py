from policy_runs import BLOCKED, HIGH, LOW, STRANGER, Run, settings

from rtron.policies import build_policy
from rtron.vocabulary import UNAPPROVED, Decision, Flow, PolicyName, Verdict

BLOCK = PolicyName.BLOCK


def test_flows_share_the_output():
    run = Run(settings(BLOCK))
    assert [run.say(flow) for flow in (LOW, HIGH, LOW)] == [Decision.PASS] * 3
    assert run.policy.owner is None
    assert run.policy.deadline() is None
    assert run.tick() == []


def test_the_verdict_names_flow_policy_reason_and_revision():
    policy = build_policy(settings(BLOCK, revision=7))
    wanted = Verdict(Decision.DROP, BLOCKED, BLOCK, "blocked is blocked", 7)
    assert policy.verdict(BLOCKED, "left", 0) == wanted
    assert policy.verdict(BLOCKED, "left", 0) is policy.verdict(BLOCKED, "left", 1)


def test_unknown_flows_are_dropped():
    policy = build_policy(settings(BLOCK))
    for flow in (STRANGER, UNAPPROVED):
        verdict = policy.verdict(flow, "left", 0)
        assert verdict.decision is Decision.DROP
        assert verdict.reason == f"{flow} is not an approved flow"


def test_unapproved_passes_where_the_settings_name_it():
    policy = build_policy(settings(BLOCK, flows=(Flow(name=UNAPPROVED, publisher="*"),)))
    assert policy.verdict(UNAPPROVED, "left", 0).decision is Decision.PASS


def test_unknown_flows_are_not_remembered():
    """Else whoever invents names would fill the memory."""
    policy = build_policy(settings(BLOCK))
    assert policy.verdict(STRANGER, "left", 0) is not policy.verdict(STRANGER, "left", 0)

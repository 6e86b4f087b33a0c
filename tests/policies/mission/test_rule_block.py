"""Rules about one topic: the most restrictive wins, and a message is judged once."""

from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st
from policy_runs import APPROVED, BLOCKED, FLOWS, HIGH, LOW, STRANGER, often, settings
from test_event_bits import event
from test_rule_status import Asked

from rtron.policies.mission.event_bits import EventBits
from rtron.policies.mission.rule_block import RuleBlock
from rtron.policies.mission.rule_status import MissionMonitor
from rtron.vocabulary import UNAPPROVED, Decision, Flow, MissionRule, PolicyName, StageRule

PASS, DROP = Decision.PASS, Decision.DROP
NOT_KNOWN = "no such field: goal"


class Judging:
    """Answers for each rule what the message says of it, and counts."""

    def __init__(self):
        self.times = 0

    def __call__(self, message):
        self.times += 1
        return message


def made(*rules, flows=FLOWS, revision=0):
    """Return a policy with (name, blocked flows, what the Rule and the StageRule say besides).

    The rule `x` asks for the event `x`.
    """
    named, staged = [], []
    for name, blocks, others in rules:
        named.append((MissionRule(name=name, block=("/goal",), when=name, **others), Asked(name)))
        staged.append(StageRule(name=name, blocked_flows=frozenset(blocks)))
    mission = MissionMonitor(EventBits([event(name) for name, _, _ in rules]), named)
    chosen = settings(PolicyName.BLOCK, flows=flows, rules=tuple(staged), revision=revision)
    judging = Judging()
    return RuleBlock(chosen, mission, judging), mission, judging


def hear(mission, now=0, **bits):
    for name, judged in bits.items():
        mission.bits.by_name[name].observe(judged, now)
    mission.update(now)


def test_what_no_rule_blocks_passes():
    policy, mission, judging = made(("fire", [LOW], {}))
    hear(mission, fire=True)
    verdict = policy.verdict(HIGH, {}, 0)
    assert (verdict.decision, verdict.reason) == (PASS, "no rule blocks high")
    assert (verdict.flow, verdict.policy) == (HIGH, PolicyName.BLOCK)
    assert policy.verdict(HIGH, {}, 1) is verdict
    assert judging.times == 0


def test_a_rule_that_holds_blocks_its_flows_and_tells_why():
    policy, mission, _ = made(("fire", [LOW], {"reason": "no goals in a fire"}), revision=4)
    hear(mission, fire=True)
    verdict = policy.verdict(LOW, {}, 0)
    assert (verdict.decision, verdict.error, verdict.revision) == (DROP, False, 4)
    assert verdict.reason == "rule fire: no goals in a fire"
    assert policy.refusal(LOW, 0) is verdict
    hear(mission, 1, fire=False)
    assert policy.verdict(LOW, {}, 1).decision is PASS
    assert policy.refusal(LOW, 1) is None


@pytest.mark.parametrize("flow", [BLOCKED, STRANGER, UNAPPROVED])
def test_blocked_and_unknown_flows_are_refused(flow):
    policy, mission, judging = made(("fire", [flow], {"action": "true"}))
    hear(mission, fire=True)
    verdict = policy.verdict(flow, {"fire": False}, 0)
    assert verdict == policy.refusal(flow, 0)
    assert (verdict.decision, verdict.error) == (DROP, False)
    assert "rule" not in verdict.reason
    assert judging.times == 0
    assert mission.statuses["fire"].is_blocking


def test_the_unapproved_flow_is_judged_by_the_rules_where_it_may_speak():
    flows = (Flow(name=UNAPPROVED, publisher="*"),)
    policy, mission, _ = made(("fire", [UNAPPROVED], {}), flows=flows)
    hear(mission, fire=False)
    assert policy.verdict(UNAPPROVED, {}, 0).decision is PASS
    hear(mission, fire=True)
    assert policy.verdict(UNAPPROVED, {}, 0).decision is DROP


@pytest.mark.parametrize(
    ("judged", "decision", "error", "reason"),
    [
        (True, DROP, False, "rule fire: while fire"),
        (False, PASS, False, "no rule blocks low"),
        (NOT_KNOWN, DROP, True, f"rule fire: while fire ({NOT_KNOWN})"),
    ],
)
def test_a_rule_looks_into_the_message(judged, decision, error, reason):
    policy, mission, _ = made(("fire", [LOW], {"action": "near(goal)"}))
    hear(mission, fire=True)
    verdict = policy.verdict(LOW, {"fire": judged}, 0)
    assert (verdict.decision, verdict.error, verdict.reason) == (decision, error, reason)
    assert policy.refusal(LOW, 0) is None


def test_a_rule_that_nobody_judges_blocks():
    policy, mission, _ = made(("fire", [LOW], {"action": "near(goal)"}))
    hear(mission, fire=True)
    assert policy.verdict(LOW, {}, 0).decision is DROP


def test_a_message_is_judged_once_for_all_rules_and_only_if_one_holds():
    policy, mission, judging = made(*((name, [LOW], {"action": "x"}) for name in "abcde"))
    hear(mission, a=False, b=True, c=True, d=False, e=True)
    assert policy.verdict(LOW, dict.fromkeys("abcde", False), 0).decision is PASS
    assert judging.times == 1
    hear(mission, b=False, c=False, e=False)
    policy.verdict(LOW, dict.fromkeys("abcde", True), 0)
    assert judging.times == 1


@dataclass(frozen=True)
class Stated:
    """A rule, its bit, and what it says of the message."""

    blocks: frozenset[str]
    action: str
    bit: bool | None
    found: bool | str

    def concerns(self, flow):
        return flow in self.blocks and self.bit is not False

    @property
    def against(self):
        return not self.action or self.found is not False


stated = st.lists(
    st.builds(
        Stated,
        st.frozensets(st.sampled_from(APPROVED)),
        st.sampled_from(["", "near(goal)"]),
        st.sampled_from([True, False, None]),
        st.sampled_from([True, False, NOT_KNOWN]),
    ),
    max_size=6,
)


@often
@given(stated, st.sampled_from(APPROVED))
def test_the_most_restrictive_rule_wins(stated, flow):
    rules = {f"r{at}": each for at, each in enumerate(stated)}
    policy, mission, judging = made(
        *((name, each.blocks, {"action": each.action}) for name, each in rules.items())
    )
    hear(mission, **{name: each.bit for name, each in rules.items()})
    judged = {name: each.found for name, each in rules.items() if each.action}
    verdict = policy.verdict(flow, judged, 0)
    concerned = {name: each for name, each in rules.items() if each.concerns(flow)}
    against = [name for name, each in concerned.items() if each.against]
    assert verdict.decision is (DROP if against else PASS)
    assert (verdict.flow, verdict.policy) == (flow, PolicyName.BLOCK)
    if against:
        assert verdict.reason.startswith(f"rule {against[0]}: ")
        assert verdict.error is (judged.get(against[0], True) is not True)
    assert judging.times <= 1
    plain = [name for name, each in concerned.items() if not each.action]
    refusal = policy.refusal(flow, 0)
    assert (refusal is not None) is bool(plain)
    assert refusal is None or refusal.reason.startswith(f"rule {plain[0]}: ")


@pytest.mark.parametrize("ask", ["verdict", "refusal"])
def test_time_alone_changes_what_is_blocked(ask):
    policy, mission, _ = made(("fire", [LOW], {}))
    hear(mission, 5, fire=False)

    def dropped(now):
        if ask == "refusal":
            return policy.refusal(LOW, now) is not None
        return policy.verdict(LOW, {}, now).decision is DROP

    assert [dropped(now) for now in (14, 15, 16)] == [False, True, True]


def test_nothing_is_held_and_nobody_owns_the_output():
    policy, _, _ = made(("fire", [LOW], {}))
    assert policy.tick(0) == policy.close() == ()
    assert policy.observe_done(0) is policy.deadline() is policy.owner is None

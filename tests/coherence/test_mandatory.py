"""What a plan makes mandatory: read, written, described, and refused where it cannot be."""

import pytest

from rtron.coherence.rsrcn import included_policies
from rtron.errors import PlanError
from rtron.planning import parse_plan, plan_json_schema, write_plan
from rtron.vocabulary import PolicyName

TEXT = """\
rsrcn:
  mode: enforce
  policy: Safe+Constrain
  threshold: 0.02
  max_vel_limit: 0.5
  vflows:
    - topic: /max_vel
      type: std_msgs/Float64
      flows: [{name: v1, publisher: /lane}]
msrcn:
  mode: enforce
  aflows:
    - topic: /goal
      flows: [{name: a1, publisher: /user}]
  eflows: [{name: night, topic: /night, publisher: /clock, present: 2 s}]
  rules: [{name: quiet, when: night, block: [/goal]}]
fps_monitor: [{node: /signs, topic: /signs/image}]
"""
RSRCN = (PolicyName.BLOCK, PolicyName.SAFE, PolicyName.CONSTRAIN, PolicyName.SAFE_CONSTRAIN)


def text(policy="Safe+Constrain", mandatory="", rule=""):
    own = f"\n  mandatory: {mandatory}" if mandatory else ""
    changed = TEXT.replace("policy: Safe+Constrain", f"policy: {policy}{own}")
    return changed.replace("[/goal]}", f"[/goal]{rule}}}")


def fault(given):
    with pytest.raises(PlanError) as caught:
        parse_plan(given, "my.yaml")
    return str(caught.value)


def test_nothing_is_mandatory_unless_said():
    plan = parse_plan(TEXT)
    assert plan.rsrcn.mandatory is None
    assert plan.msrcn.rules[0].mandatory is False
    assert "mandatory:" not in _uncommented(write_plan(plan))


@pytest.mark.parametrize("mandatory", ["Safe", "Constrain", "Safe+Constrain"])
@pytest.mark.parametrize("rule", ["", ", mandatory: true", ", mandatory: false"])
def test_it_is_read_and_written(mandatory, rule):
    plan = parse_plan(text(mandatory=mandatory, rule=rule))
    assert plan.rsrcn.mandatory == mandatory
    assert plan.msrcn.rules[0].mandatory is rule.endswith("true")
    assert parse_plan(write_plan(plan)) == plan


@pytest.mark.parametrize("policy", RSRCN)
@pytest.mark.parametrize("mandatory", RSRCN)
def test_the_policy_includes_what_is_mandatory(policy, mandatory):
    given = text(policy, mandatory)
    if mandatory in included_policies(policy):
        assert parse_plan(given).rsrcn.mandatory is mandatory
    else:
        why = f"the policy is {policy}, which does not include it"
        assert fault(given) == f"my.yaml:4: {mandatory} cannot be mandatory: {why}"


def test_what_includes_what():
    assert {policy: set(included_policies(policy)) for policy in RSRCN} == {
        PolicyName.BLOCK: {PolicyName.BLOCK},
        PolicyName.SAFE: {PolicyName.SAFE},
        PolicyName.CONSTRAIN: {PolicyName.CONSTRAIN},
        PolicyName.SAFE_CONSTRAIN: {
            PolicyName.SAFE,
            PolicyName.CONSTRAIN,
            PolicyName.SAFE_CONSTRAIN,
        },
    }


def test_it_is_a_policy_of_the_rsrcn():
    told = "Preemption is not for the RSRCN: choose from Block, Safe, Constrain, Safe+Constrain"
    assert fault(text(mandatory="Preemption")) == f"my.yaml:4: {told}"


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (text(mandatory="Saef"), "unknown word 'Saef': did you mean Safe?"),
        (text(rule=", mandatory: yes"), "'yes' is neither true nor false"),
        (text(rule=", mandatry: true"), "did you mean mandatory?"),
    ],
)
def test_slips(given, told):
    assert told in fault(given)


def test_the_schema_has_both():
    nouns = plan_json_schema()["$defs"]
    policies = {"enum": [word.value for word in PolicyName]}
    assert nouns["RSRCN"]["properties"]["mandatory"] == {"anyOf": [policies, {"type": "null"}]}
    assert nouns["MissionRule"]["properties"]["mandatory"] == {"type": "boolean"}


def _uncommented(written):
    return "\n".join(line for line in written.splitlines() if not line.startswith("#"))

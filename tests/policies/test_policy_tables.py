"""The tables are total, and each policy has its page."""

import doctest
from importlib import import_module
from itertools import product

import pytest
from docs_policies import PAGES, stale
from policy_runs import settings

from rtron.errors import PlanError
from rtron.policies import POLICIES, block, build, preemption, queueing
from rtron.policies.machine import Effect, Machine
from rtron.vocabulary import Flow, PolicyName, StreamKind

TABLED = (block, preemption, queueing)
HEADINGS = ("What it does", "When to use it", "Settings", "States", "Example")


@pytest.mark.parametrize("module", TABLED)
def test_every_input_is_answered_in_every_state(module):
    assert set(module.TABLE) == set(product(module.State, module.Input))


@pytest.mark.parametrize("module", TABLED)
def test_every_state_can_be_reached(module):
    first = next(iter(module.State))
    reached = {first}
    for _ in module.State:
        reached |= {after for (state, _), (after, _) in module.TABLE.items() if state in reached}
    assert reached == set(module.State)


@pytest.mark.parametrize("module", TABLED)
def test_what_cannot_arise_raises_and_changes_nothing(module):
    never = [(pair, to) for pair, to in module.TABLE.items() if to[1] is Effect.NEVER]
    for (state, input), (after, _) in never:
        machine = Machine(module.TABLE, state)
        with pytest.raises(AssertionError, match=input.name):
            machine.step(input)
        assert machine.state is state is after


@pytest.mark.parametrize("policy", POLICIES)
def test_each_policy_is_documented(policy):
    module = import_module(POLICIES[policy].__module__)
    headings = [line[3:] for line in module.__doc__.splitlines() if line.startswith("## ")]
    assert headings == list(HEADINGS)
    assert module.__doc__.startswith(f"{policy}: ")


@pytest.mark.parametrize("policy", POLICIES)
def test_the_examples_are_true(policy):
    found = doctest.testmod(import_module(POLICIES[policy].__module__))
    assert found.attempted
    assert not found.failed


def test_the_pages_are_current():
    assert not stale(PAGES)
    assert {page.stem for page in PAGES.glob("*.md")} == {str(policy) for policy in POLICIES}


def test_a_stale_page_is_found(tmp_path):
    assert {page.stem for page in stale(tmp_path)} == {str(policy) for policy in POLICIES}


@pytest.mark.parametrize("policy", [PolicyName.SAFE, PolicyName.CONSTRAIN])
def test_safe_and_constrain_are_not_available_yet(policy):
    with pytest.raises(PlanError, match=f"{policy} is not available yet") as raised:
        build(settings(policy))
    assert "Preemption" in raised.value.help


@pytest.mark.parametrize("policy", POLICIES)
@pytest.mark.parametrize("kind", StreamKind)
def test_equal_priorities_are_refused_where_priorities_count(policy, kind):
    equal = tuple(Flow(name=name, publisher="/any") for name in ("flow1", "flow2"))
    if policy in {PolicyName.BLOCK, PolicyName.FIFO_QUEUE}:
        build(settings(policy, kind, equal))
    else:
        with pytest.raises(PlanError, match="flow1 and flow2 have the same priority 0"):
            build(settings(policy, kind, equal))

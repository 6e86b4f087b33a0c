"""The tables are total, and each policy has its page."""

import doctest
import re
from importlib import import_module
from itertools import product

import pytest
from docs_files import stale
from docs_policies import PAGES, documents
from policy_runs import LIMITS, settings

from rtron.errors import PlanError
from rtron.policies import POLICIES, block, build_policy, preemption, velocity_watchdog
from rtron.policies.authority import lease
from rtron.policies.queues import message_queue
from rtron.policies.state_machine import StateMachine, TransitionEffect
from rtron.policies.velocity_limit import limiter
from rtron.vocabulary import Flow, PolicyName, StreamKind

TABLED = (block, preemption, lease, message_queue, limiter, velocity_watchdog)
HEADINGS = ("What it does", "When to use it", "Settings", "States", "Example")


def enums(module):
    """Return the states and the inputs of a module's table."""
    state, input = next(iter(module.TABLE))
    return type(state), type(input)


@pytest.mark.parametrize("module", TABLED)
def test_every_input_is_answered_in_every_state(module):
    states, inputs = enums(module)
    assert set(module.TABLE) == set(product(states, inputs))


@pytest.mark.parametrize("module", TABLED)
def test_every_state_can_be_reached(module):
    states, _ = enums(module)
    reached = {next(iter(states))}
    for _ in states:
        reached |= {after for (state, _), (after, _) in module.TABLE.items() if state in reached}
    assert reached == set(states)


@pytest.mark.parametrize("module", TABLED)
def test_what_cannot_arise_raises_and_changes_nothing(module):
    never = [(pair, to) for pair, to in module.TABLE.items() if to[1] is TransitionEffect.NEVER]
    for (state, input), (after, _) in never:
        machine = StateMachine(module.TABLE, state)
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
    assert not stale(documents())
    assert {page.stem for page in PAGES.glob("*.md")} == {*map(str, POLICIES), "README"}


def test_a_stale_page_is_found(tmp_path):
    assert {page.stem for page in stale(documents(tmp_path))} == {*map(str, POLICIES), "README"}


@pytest.mark.parametrize(
    ("policy", "key"),
    [
        (PolicyName.SAFE, "threshold"),
        (PolicyName.CONSTRAIN, "max_vel_limit"),
        (PolicyName.SAFE_CONSTRAIN, "threshold"),
        (PolicyName.SAFE_CONSTRAIN, "max_vel_limit"),
    ],
)
def test_a_limit_that_is_not_given_is_refused(policy, key):
    with pytest.raises(PlanError, match=f"^{re.escape(policy)} needs {key}$") as raised:
        build_policy(settings(policy, **{key: None}))
    assert raised.value.help == f"set {key} of the RSRCN"


@pytest.mark.parametrize("policy", LIMITS)
def test_flows_that_have_an_order_have_it_among_all(policy):
    flows = tuple(
        Flow(name=name, publisher="/any", priority=priority)
        for name, priority in (("flow1", 1), ("flow2", 2), ("flow3", 1))
    )
    with pytest.raises(PlanError, match="flow1 and flow3 have the same priority 1"):
        build_policy(settings(policy, flows=flows))


@pytest.mark.parametrize("policy", POLICIES)
@pytest.mark.parametrize("kind", StreamKind)
def test_equal_priorities_are_refused_where_priorities_count(policy, kind):
    equal = tuple(Flow(name=name, publisher="/any") for name in ("flow1", "flow2"))
    if policy in {PolicyName.BLOCK, PolicyName.FIFO_QUEUE, PolicyName.LEASE, *LIMITS}:
        build_policy(settings(policy, kind, equal))
    else:
        with pytest.raises(PlanError, match="flow1 and flow2 have the same priority 0"):
            build_policy(settings(policy, kind, equal))

"""A launch gives a parameter another type than its node declares.

## What it finds

In ROS 2 a launch, or its YAML file, gives a parameter another type than the node declares. ROS 2
(Galactic and newer) converts none: the call throws `InvalidParameterTypeException`. The node ends
at its start, a component is not loaded, and a lifecycle node is not configured.

For example, `params.yaml` sets `max_vel: 1` of `/base`, which calls
`declare_parameter("max_vel", 0.5)`.

## What to do

Write the value in the declared type (`1.0`), or declare the type that is given.

## When it is silent

- Where a type is not certain: a C++ default that holds an integer and has no template argument, or
  a text that looks like a number.
- Where the call has a descriptor, or its exception is caught.
- Where the node declares all that is set for it.
- On ROS 1.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule
from rtron.findings.wiring_groups import fact_finding
from rtron.vocabulary import Finding, WiringFact, WiringFactKind
from rtron.wording import join_names


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each parameter that a node is given in another type than it declares."""
    facts = (f for f in app.graph.wiring if f.kind is WiringFactKind.MISTYPED_PARAMETER)
    yield from map(_finding, {(fact.subject, fact.value): fact for fact in facts}.values())


def _finding(fact: WiringFact) -> Finding:
    node, name = fact.subject, fact.value
    declared, given = join_names(fact.others[:1]), join_names(fact.others[1:])
    return fact_finding(
        RULE.name,
        fact,
        subject=f"{node}:{name}",
        summary=f"{node} does not start: the launch gives {name} another type",
        cause=f"the node declares it as {declared}, the launch gives it as {given}",
        remedy=f"write the value as {declared}, or declare {given} in the node",
        nodes=(node,),
    )


RULE = FindingRule(
    name="mistyped_parameter",
    title="A launch gives a parameter another type than its node declares",
    consequence="failure: likely",
    since="0.1.0",
    check=check,
)

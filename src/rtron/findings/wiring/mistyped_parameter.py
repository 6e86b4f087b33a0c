"""A launch gives a parameter another type than its node declares.

## What it finds

In ROS 2, a parameter in a launch file, or in a YAML file that it gives to a node, whose type is not
the one that the node's source declares: by the default of `declare_parameter`, by its template
argument in C++, or by a type such as `Parameter.Type.DOUBLE`. A type that is not certain on either
side says nothing: a default of C++ without a template argument that holds an integer, a text that
looks like a number. A call with a descriptor does not count, nor a node that declares all that is
set for it, nor a call whose exception is caught.

## Why it matters

A parameter keeps its type, and ROS 2 (Galactic and newer) converts none: `max_vel: 1` is no double.
The call throws `InvalidParameterTypeException`: the node ends at its start, a component is not
loaded, a lifecycle node that declares it later is not configured.

## Remedy

Write the value in the declared type, or declare the type that is given.

## Example

`params.yaml` sets `max_vel: 1` of `/base`, which calls `declare_parameter("max_vel", 0.5)`.
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
    since="0.2.0",
    check=check,
)

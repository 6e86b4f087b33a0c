"""A behavior tree or a client asks a server for a plugin that it does not have.

## What it finds

A planner, controller, smoother or checker that a behavior tree of Nav2, or a request of your own
node, names by its id, and that is not in the list of plugins of its server. The server refuses each
request: the robot does not drive.

For example, `behavior.xml` has `planner_id="GridBased"`, and `planner_plugins` of `/planner_server`
is `["StraightLine"]`.

## What to do

Write an id that the server has, or add the plugin to the server's list.

## When it is silent

Where an id is not known, such as one of the tree's blackboard, and where two servers are in the
namespace.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule
from rtron.findings.wiring_groups import WiringGroup, fact_finding, wiring_groups
from rtron.vocabulary import Finding, WiringFactKind
from rtron.wording import join_names


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each id that is asked for in vain."""
    yield from map(_finding, wiring_groups(app.graph, WiringFactKind.MISSING_PLUGIN))


def _finding(group: WiringGroup) -> Finding:
    field, _, plugin = group.subject.rpartition("/")
    kind, server = field.rpartition("/")[2], group.values[0]
    known = join_names(group.others)
    return fact_finding(
        RULE.name,
        group,
        summary=f"{kind} {plugin} is asked for, which {server} does not have",
        cause=f"of this kind it has {known} alone",
        remedy=f"ask for {known}, or add {plugin} to the plugins of {server}",
        nodes=(server,),
    )


RULE = FindingRule(
    name="missing_plugin",
    title="A behavior tree or a client asks a server for a plugin that it does not have",
    consequence="failure: likely",
    since="0.1.0",
    check=check,
)

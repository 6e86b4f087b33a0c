"""Some nodes follow simulated time, others do not.

## What it finds

The parameter `use_sim_time` of a ROS 2 node differs from that of most others. Their stamps are
years apart: transforms are not found, and watchdogs that compare stamps never fire or always do.

For example, eight nodes have `use_sim_time: true`, `/ekf` has not.

## What to do

Give all nodes the same value: `SetParameter('use_sim_time', …)` at the top of the launch file.

## When it is silent

For the simulator and its bridges, spawners of controllers, and helper nodes of Nav2's servers.
"""

import re
from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import Certainty, Consequence, Finding, Node
from rtron.wording import conjugate, join_names

_SIMULATORS = ("gazebo_", "ros_gz", "ros_ign")
_TOOL = "_ros2cli"
"""How the nodes of the command line tools begin, which end at once."""
_NAV2_HELPER = re.compile(r".*_rclcpp_node|(?:/.*)?/(\w+)/\1")
"""A server's node for its behaviour tree, and a costmap, which lies in a namespace of its name."""


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding where use_sim_time is not the same everywhere."""
    values: dict[bool, list[str]] = {True: [], False: []}
    for parameter in app.graph.parameters:
        is_time = parameter.name == "use_sim_time" and _keeps_time(app, parameter.node)
        if is_time and isinstance(parameter.value, bool):
            values[parameter.value].append(parameter.node)
    if not values[True] or not values[False]:
        return
    few, value = min((sorted(nodes), value) for value, nodes in values.items())
    if len(values[not value]) < len(few):
        few, value = sorted(values[not value]), not value
    yield make_finding(
        RULE.name,
        "use_sim_time",
        summary=f"{join_names(few)} {conjugate(few, 'live')} in another time than the other nodes",
        cause=f"use_sim_time is {str(value).lower()} there, {str(not value).lower()} elsewhere",
        remedy="set use_sim_time once for all nodes",
        consequence=Consequence.FAILURE,
        certainty=Certainty.CERTAIN,
        nodes=few,
        evidence=app.node_evidence(few),
    )


def _keeps_time(app: AppFacts, node: str) -> bool:
    """Return whether it matters which time a node has."""
    known = app.nodes.get(node, Node(name=node))
    is_simulator = known.package.startswith(_SIMULATORS)
    is_helper = known.package.startswith("nav2_") and bool(_NAV2_HELPER.fullmatch(node))
    is_spawner = known.package == "controller_manager" and "spawner" in known.executable
    is_static = known.executable == "static_transform_publisher"  # tf2 takes it at any time
    is_tool = is_spawner or node.rpartition("/")[2].startswith(_TOOL)
    return not (is_simulator or is_helper or is_tool or is_static or node in app.facts.viewers)


RULE = FindingRule(
    name="sim_time",
    title="Some nodes follow simulated time, others do not",
    consequence="failure: certain",
    since="0.1.0",
    check=check,
)

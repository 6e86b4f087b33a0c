"""A bridge to Gazebo carries a topic past the robot, or in the wrong direction.

## What it finds

On ROS 2 an entry of `ros_gz_bridge` names a topic of Gazebo that no plugin or sensor of the spawned
robots has, while one of its type is bridged by nobody. Or the entry carries a plugin's topic the
other way, or the clock both ways. The bridge starts without a fault, and nothing arrives.

For example, the bridge writes to `/model/bot/cmd_vel`, and DiffDrive's `<topic>` is `cmd_vel`.

## What to do

Give the entry the name that the robot has, or the sensor a `<topic>`. From Gazebo to ROS the sign
is `[` or `GZ_TO_ROS`, from ROS to Gazebo `]` or `ROS_TO_GZ`. `@` carries both ways; Gazebo gives no
time while somebody else does.

## When it is silent

Where more than one name is left over on a side, and for contacts and forces. Names are not compared
where the bridge's namespace tells of another model, such as one of a world file, and where a robot
has a plugin whose topics are not known.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule
from rtron.findings.wiring_groups import WiringGroup, fact_finding, wiring_groups
from rtron.vocabulary import Finding, WiringFactKind
from rtron.wording import conjugate, join_names


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each topic of Gazebo that bridges do not carry as its plugin needs it."""
    yield from map(_finding, wiring_groups(app.graph, WiringFactKind.BRIDGE_MISMATCH))


def _finding(group: WiringGroup) -> Finding:
    bridges, topic, (meant, *_) = join_names(group.others), group.subject, group.values
    connect, is_other_name = conjugate(group.others, "connect"), meant != topic
    return fact_finding(
        RULE.name,
        group,
        summary=f"{bridges} {connect} Gazebo's {topic}, which the robot does not have"
        if is_other_name
        else f"{bridges} {connect} Gazebo's {topic} in the wrong direction",
        cause=f"the robot has {meant}, which nobody bridges"
        if is_other_name
        else "who sends it is on the other side",
        remedy=f"write {meant} in the bridge, or {topic} as <topic> in the robot"
        if is_other_name
        else "write the other sign, [ or ], or the other direction",
        nodes=group.others,
    )


RULE = FindingRule(
    name="bridge_mismatch",
    title="A bridge to Gazebo carries a topic past the robot, or in the wrong direction",
    consequence="failure: likely",
    since="0.1.0",
    check=check,
)

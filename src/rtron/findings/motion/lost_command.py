"""A motion command reaches nobody.

## What it finds

A topic that commands motion, that nobody subscribes, while another one of its type is obeyed that
it likely means: one of the two was left out of a remap. That is

- an obeyed topic of the same name in a namespace above or below;
- one beside it whose name says more or less (`control_mode`, `offboard_control_mode`);
- whatever its name, the only obeyed topic that nobody publishes, if it moves the same thing: a
  base, an arm, a head.

The last does not count for types of `std_msgs`, which say too little; where the senders have
another output of the type, or the readers another input in use; between namespaces of two robots,
and between twins (`left_arm`, `right_arm`). A velocity that tells of a motion (of a driver that
publishes odometry, `measured`, `estimated`) is no command. Who obeys the one and publishes the
other forwards it, and does not count, nor where other nodes stand between.

What was not read may be the missing end: a subscription of a name known in part, of the same type;
a node or launch file, unless its name says that it commands no motion (a camera or a map, but no
`camera_rover_driver`), or its remaps and parameters name other commands. Then only the same name
counts, from the level `pedantic` on. What may be an input of the autopilot PX4 (`/fmu/in/…`) is
`pedantic`.

## Why it matters

What the node commands never happens: a recovery that should free the robot, a stop that should hold
it. No node fails, and the log says nothing.

## Remedy

Remap the topic to the one that is obeyed, if the finding is likely.

## Example

`/collision_monitor` publishes `/cmd_vel`, and `/wheel_controller` obeys `/wheel_cmd`.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.lost_commands import lost_commands
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import Certainty, Consequence, Direction, Finding, FindingLevel
from rtron.wording import conjugate, join_names


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each motion topic without a reader that likely means an obeyed one."""
    for topic, obeyed in lost_commands(app).items():
        yield _finding(app, topic, obeyed)


def _finding(app: AppFacts, topic: str, obeyed: str) -> Finding:
    publishers, readers = app.publishers(topic), app.readers(obeyed)
    maybe_read = app.may_have_other_end(topic, Direction.SUBSCRIBE)
    others = "" if app.publishers(obeyed) else ", which nobody publishes"
    return make_finding(
        RULE.name,
        topic,
        summary=f"what {join_names(publishers)} {conjugate(publishers, 'command')} on {topic} "
        "reaches nobody",
        cause=f"no node of this launch subscribes it{app.unread_hint if maybe_read else ''}; "
        f"{join_names(readers)} {conjugate(readers, 'obey')} {obeyed}{others}",
        remedy=f"find out who should obey {topic}; {obeyed} may be another thing"
        if maybe_read
        else f"remap {topic} to {obeyed}",
        consequence=Consequence.FAILURE,
        certainty=Certainty.POSSIBLE if maybe_read else Certainty.LIKELY,
        level=FindingLevel.PEDANTIC if maybe_read else FindingLevel.REGULAR,
        nodes=(*publishers, *readers),
        topics=(topic, obeyed),
        evidence=app.evidence((*app.graph.publishers(topic), *app.graph.subscribers(obeyed))),
    )


RULE = FindingRule(
    name="lost_command",
    title="A motion command reaches nobody",
    consequence="failure: likely, possible where something was not read",
    since="0.2.0",
    check=check,
)

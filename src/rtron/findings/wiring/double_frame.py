"""Two nodes broadcast the transform of one frame.

## What it finds

Nodes that broadcast one child frame of TF, of any parent. The frames are read from the arguments of
`static_transform_publisher`, from the parameters of well-known nodes (robot_localization, amcl,
controllers, Gazebo's plugins and others), and from the source of nodes that call `sendTransform`.
A node whose parameters turn its transforms off does not count. Names that only the running app
knows do not count either.

Where all of them send a transform that never changes, below one parent, the level is `pedantic`. So
it is where a condition that is not known decides whether more than one node does it: a node that
the launch may leave out, or a managed node of ROS 2 that no lifecycle manager of Nav2 activates.

## Why it matters

A frame has one parent. tf2 takes whatever came last: the frame, and all below it, jumps between two
parents or two poses. The robot jumps on the map, the planner drives around obstacles that are not
there, and no node reports a fault.

## Remedy

Let one node broadcast the frame. Most nodes have a parameter that turns their transform off, such
as `publish_tf` or `enable_odom_tf`.

## Example

`/ekf` and `/diff_drive_controller` both broadcast `base_link` below `odom`.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence

from rtron.findings.app_facts import AppFacts
from rtron.findings.rule import FindingRule, make_finding
from rtron.findings.wiring_groups import WiringGroup, wiring_groups
from rtron.vocabulary import Certainty, Consequence, Finding, FindingLevel, WiringFactKind
from rtron.wording import both_or_all, join_names

_KINDS = {
    WiringFactKind.DOUBLE_FRAME: (Certainty.LIKELY, FindingLevel.REGULAR),
    WiringFactKind.DOUBLE_FIXED_FRAME: (Certainty.POSSIBLE, FindingLevel.PEDANTIC),
    WiringFactKind.POSSIBLE_DOUBLE_FRAME: (Certainty.POSSIBLE, FindingLevel.PEDANTIC),
}


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each set of nodes, with the frames that all of them broadcast.

    What is shown of a frame is the surest of its facts.
    """
    shown: set[str] = set()
    for kind in _KINDS:
        by_nodes: dict[tuple[str, ...], list[WiringGroup]] = defaultdict(list)
        for group in wiring_groups(app.graph, kind):
            if group.subject not in shown:
                by_nodes[tuple(sorted(group.others))].append(group)
        for nodes, groups in by_nodes.items():
            shown.update(group.subject for group in groups)
            yield _finding(nodes, groups, kind)


def _finding(
    nodes: tuple[str, ...], groups: Sequence[WiringGroup], kind: WiringFactKind
) -> Finding:
    certainty, level = _KINDS[kind]
    frames = [group.subject for group in groups]
    noun = "frames" if frames[1:] else "frame"
    return make_finding(
        RULE.name,
        frames[0],
        summary=f"{_broadcasters(nodes)} broadcast the {noun} {join_names(frames)}",
        cause=_cause(groups, kind),
        remedy=f"let one node broadcast {join_names(frames)}",
        consequence=Consequence.FAILURE,
        certainty=certainty,
        level=level,
        nodes=nodes,
        evidence=(place for group in groups for place in group.evidence),
    )


def _broadcasters(nodes: tuple[str, ...]) -> str:
    """Name the nodes; those that give themselves a name have one in common."""
    names = join_names(nodes)
    return f"{names} {both_or_all(nodes)}" if nodes[1:] else f"several {names}"


def _cause(groups: Sequence[WiringGroup], kind: WiringFactKind) -> str:
    parents = [parent for parent in groups[0].values if parent and not groups[1:]]
    below = f" below {parents[0]}" if parents else ""
    if parents[1:]:
        cause = f"its parents are {join_names(parents)}"
    elif kind is WiringFactKind.DOUBLE_FIXED_FRAME:
        cause = f"each sends a transform that never changes{below}"
    else:
        cause = f"each sends a pose of its own{below}"
    is_possible = kind is WiringFactKind.POSSIBLE_DOUBLE_FRAME
    return f"{cause}; conditions that are not known decide which do" if is_possible else cause


RULE = FindingRule(
    name="double_frame",
    title="Two nodes broadcast the transform of one frame",
    consequence="failure: likely",
    since="0.2.0",
    check=check,
)

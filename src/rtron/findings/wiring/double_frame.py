"""Two nodes broadcast the transform of one frame.

## What it finds

Two nodes broadcast one child frame of TF. The frame then jumps between two parents or poses: the
robot jumps on the map, and no node reports a fault.

For example, `/ekf` and `/diff_drive_controller` both broadcast `base_link` below `odom`.

## What to do

Let one node broadcast the frame. Most nodes have a parameter for it, such as `publish_tf` or
`enable_odom_tf`.

## When it is silent

With names that only the running app knows. Static transforms below one parent, and nodes that the
launch may leave out, are `pedantic`.
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
    since="0.1.0",
    check=check,
)

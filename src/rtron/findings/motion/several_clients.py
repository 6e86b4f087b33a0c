"""Several nodes send goals that move the robot to one action.

## What it finds

An action that moves the robot (a trajectory, a pose, a dock) has more than one client. Most servers
give up the goal in progress for a new one.

For example, `/mission` and `/teleop_goals` both send goals to `/navigate_to_pose`.

## What to do

`rtron plan` proposes a GRCN before the server: goals wait, or go by priority.

## When it is silent

Below the level `pedantic`; among nodes of one stack, such as Nav2's servers; for viewers and the
server itself.
"""

from collections import defaultdict
from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.node_kinds import is_one_stack
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import ActionRole, Certainty, Consequence, Finding, FindingLevel
from rtron.wording import both_or_all, join_names

_MOTIONS = ("Trajectory", "Navigate", "FollowPath", "FollowWaypoints", "MoveBase", "MoveGroup")
_MOTIONS_OF_NAV2 = (
    "Spin",
    "BackUp",
    "DriveOnHeading",
    "DockRobot",
    "UndockRobot",
    "AssistedTeleop",
)


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each motion action with several clients."""
    clients: dict[str, set[str]] = defaultdict(set)
    for each in app.graph.actions:
        counts = each.role is ActionRole.CLIENT and each.node not in app.facts.viewers
        if counts and "{" not in each.name and _moves(each.type):
            clients[each.name].add(each.node)
    for name, nodes in sorted(clients.items()):
        servers = _servers(app, name)
        others = sorted(nodes.difference(servers))
        if len(others) > 1 and not is_one_stack(app, tuple(others)):
            yield _finding(name, others, servers)


def _servers(app: AppFacts, name: str) -> list[str]:
    return [a.node for a in app.graph.actions if a.name == name and a.role is ActionRole.SERVER]


def _moves(type: str) -> bool:
    name = type.rpartition("/")[2]
    return name in _MOTIONS_OF_NAV2 or any(word in name for word in _MOTIONS)


def _finding(name: str, nodes: list[str], servers: list[str]) -> Finding:
    server = join_names(servers) if servers else "its server"
    return make_finding(
        RULE.name,
        name,
        summary=f"{join_names(nodes)} {both_or_all(nodes)} send goals to {name}",
        cause=f"nothing decides between them: {server} takes the goal that comes last",
        remedy=f"put a guard before {name}: `rtron plan` proposes a GRCN",
        consequence=Consequence.MOTION,
        certainty=Certainty.POSSIBLE,
        level=FindingLevel.PEDANTIC,
        nodes=(*nodes, *servers),
        topics=(name,),
    )


RULE = FindingRule(
    name="several_clients",
    title="Several nodes send goals that move the robot to one action",
    consequence="motion: possible",
    since="0.1.0",
    check=check,
)

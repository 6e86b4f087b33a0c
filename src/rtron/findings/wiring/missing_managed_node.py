"""A lifecycle manager waits for a node that is not there, or does not know one.

## What it finds

A name in the `node_names` of a lifecycle manager of Nav2 that no node of the launch has. The
manager waits for it and activates none of the others. Or the launch starts a lifecycle node that
nobody configures and activates: it publishes nothing. Without a manager it counts if others read
what it publishes.

For example, `/lifecycle_manager` manages `/recoveries_server`, and the launch starts
`/behavior_server`.

## What to do

Start the node, correct its name or namespace, or remove it from `node_names`. Add one that lacks.

## When it is silent

Below `pedantic`, where something was not read, or where the launch starts no other node of the
manager and no lifecycle node of a near name. A node that nobody activates is none where something
was not read, where an event of a launch file, `ros2 lifecycle set` or a client of a name that is
not known may be for it, and if it changes its own state. Without a manager, whatever may start or
be one makes it none: a process, code that was not followed. So does a publisher of rclpy, which
publishes before it is active.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence

from rtron.findings.app_facts import AppFacts
from rtron.findings.near_names import near_names
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import (
    Certainty,
    Consequence,
    Finding,
    Service,
    ServiceClient,
    UnresolvedCause,
    WiringFactKind,
    fits_open_name,
)
from rtron.vocabulary.names import TRANSFORM_TOPICS
from rtron.wording import join_names

_MANAGER = "nav2_lifecycle_manager"
_CALLED = ("/change_state", "/get_state")
_OF_VALUES = (
    UnresolvedCause.ARGUMENT,
    UnresolvedCause.UNSET_VARIABLE,
    UnresolvedCause.RUN_TIME,
    UnresolvedCause.INCOMPLETE_DESCRIPTION,
)
"""Why notes are made that are not about a program or its code."""


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each manager that waits for nodes that are not there."""
    present = {*app.nodes, *_nodes(app.graph.services)}
    managers = [each.name for each in app.graph.nodes if each.package == _MANAGER]
    managed = {manager: _managed_nodes(app, manager) for manager in managers}
    unmanaged = sorted(set(_nodes(app.graph.services)).difference(*managed.values()))
    for manager, names in managed.items():
        missing = [name for name in names if name not in present]
        if missing:
            is_in_part = len(missing) < len(names)
            yield _finding(app, manager, missing, unmanaged, is_in_part=is_in_part)
    is_all = app.nodes.keys() >= {name for names in managed.values() for name in names}
    if app.is_whole and is_all and len(managers) <= 1:
        yield from _not_activated(app, managed)


def _not_activated(app: AppFacts, managed: Mapping[str, list[str]]) -> Iterator[Finding]:
    """Yield a finding for the nodes whom nobody activates, neither the one manager nor another.

    Those of a manager's programs are left out; without one, those whose topics nobody reads, and
    all where something that was not read may activate them.
    """
    of_manager = [name for names in managed.values() for name in names]
    programs = {(app.nodes[each].package, app.nodes[each].executable) for each in of_manager}
    idle = [
        each
        for each in _idle_nodes(app)
        if (app.nodes[each].package, app.nodes[each].executable) not in programs
        and (of_manager or not (managed or _may_be_managed(app)))
        and (of_manager or _is_read(app, each))
    ]
    if idle:
        names, manager = join_names(idle), next(iter(managed), "")
        yield make_finding(
            RULE.name,
            idle[0],
            summary=f"nobody configures and activates {names}",
            cause=f"the node_names of {manager} are {join_names(of_manager)}"
            if manager
            else "this launch has no lifecycle manager, and no event or command for it",
            remedy=f"add {names} to node_names of {manager}"
            if manager
            else f"start a lifecycle manager with {names} in its node_names, or emit ChangeState",
            consequence=Consequence.FAILURE,
            certainty=Certainty.LIKELY,
            nodes=(*idle, *managed),
            topics=[f"{name}{_CALLED[0]}" for name in idle],
            evidence=(*app.node_evidence(idle), *app.node_evidence(managed)),
        )


def _may_be_managed(app: AppFacts) -> bool:
    """Return whether something that was not read may be a manager, or ask for a state."""
    return any(note.cause not in _OF_VALUES for note in app.graph.unresolved)


def _idle_nodes(app: AppFacts) -> list[str]:
    """Return the lifecycle nodes whose state nothing changes; none where any may be meant."""
    events = {e.value for e in app.graph.wiring if e.kind is WiringFactKind.TRANSITION}
    called = (each.name for each in app.graph.clients)
    if any("{" in name and name.endswith(_CALLED[0]) for name in called):
        return []
    others = set(_nodes(app.graph.services)).difference(_nodes(app.graph.clients))
    found = (each for each in sorted(others & app.nodes.keys()) if "" not in events)
    return [each for each in found if each.rpartition("/")[2] not in events]


def _is_read(app: AppFacts, node: str) -> bool:
    """Return whether another node reads what a node publishes once it is active.

    Publishers of rclpy publish before that, too (rclpy's LifecycleNode).
    """
    sent = {
        end.topic
        for end in app.graph.published_by(node)
        if not (end.implicit or any(at.file.endswith(".py") for at in end.evidence[-1:]))
    }
    return any({*app.readers(topic)} - {node} for topic in sent - {*TRANSFORM_TOPICS})


def is_managing(app: AppFacts, node: str, service: str) -> bool:
    """Return whether a node calls a service as the manager of the node that should offer it."""
    is_manager = node in app.nodes and app.nodes[node].package == _MANAGER
    return is_manager and service.endswith(_CALLED)


def _managed_nodes(app: AppFacts, manager: str) -> list[str]:
    calls = (each for each in app.graph.clients if each.node == manager)
    return _nodes(each for each in calls if is_managing(app, manager, each.name))


def _nodes(services: Iterable[Service | ServiceClient]) -> list[str]:
    """Return the lifecycle nodes whose states services change."""
    state = _CALLED[0]
    found = (each.name.removesuffix(state) for each in services if each.name.endswith(state))
    return [name for name in dict.fromkeys(found) if "{" not in name]


def _finding(
    app: AppFacts,
    manager: str,
    missing: Sequence[str],
    unmanaged: Sequence[str],
    *,
    is_in_part: bool,
) -> Finding:
    near = list(dict.fromkeys(each for name in missing for each in near_names(name, unmanaged)))
    is_open = any(fits_open_name(name, app.nodes) for name in missing)
    is_likely = app.is_whole and not is_open and bool(is_in_part or near)
    others = f"; {join_names(unmanaged)} {'have' if unmanaged[1:] else 'has'} no manager"
    remedy = f"start {join_names(missing)}, or remove it from node_names"
    return make_finding(
        RULE.name,
        manager,
        summary=f"{manager} waits for {join_names(missing)} and activates none of its nodes",
        cause=f"no node of this launch has this name{app.unread_hint}{others if unmanaged else ''}",
        remedy=f"did you mean {near[0]}? Else {remedy}" if near else remedy,
        consequence=Consequence.FAILURE,
        certainty=Certainty.LIKELY if is_likely else Certainty.POSSIBLE,
        nodes=(manager,),
        topics=[f"{name}{_CALLED[0]}" for name in missing],
        evidence=app.node_evidence([manager]),
    )


RULE = FindingRule(
    name="missing_managed_node",
    title="A lifecycle manager waits for a node that is not there, or does not know one",
    consequence="failure: likely where the launch starts other nodes of it, else possible",
    since="0.1.0",
    check=check,
)

"""A coordination node as the paper's console shows it: its risk model, and what may be set."""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from sqlalchemy.orm import Session

from rtron.coherence import EffectivePlan, grcn, msrcn, rsrcn
from rtron.service.controller.robot_snapshot import active_settings, load_snapshot
from rtron.service.domain.errors import NotFoundError
from rtron.service.domain.principal import UserRole
from rtron.service.domain.rights import granted_rights
from rtron.service.domain.risk_model import (
    CoordinationNode,
    Violation,
    describe_violation,
    node_json,
    planned_nodes,
    topics,
)
from rtron.service.domain.schemas import NodeParameters
from rtron.service.store.robots import coordination_nodes
from rtron.service.store.tables import CoordinationNodeRow
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    CoordinationKind,
    FpsMonitor,
    Mode,
    NodeSettings,
    PolicyName,
    Settings,
    Sharing,
)

_Json = Mapping[str, dict[str, Any]]


@dataclass(frozen=True, slots=True, kw_only=True)
class _NodesView:
    """What the nodes of one robot are shown from, to somebody with these roles."""

    nodes: Mapping[str, tuple[CoordinationKind, CoordinationNode, CoordinationNode]]
    rows: Mapping[str, CoordinationNodeRow]
    planned_json: _Json
    effective_json: _Json
    settings: Settings
    roles: Collection[UserRole]


def list_node_parameters(
    session: Session, robot: str, roles: Collection[UserRole], now: int
) -> list[NodeParameters]:
    """Return the coordination nodes of a robot, as somebody with these roles sees them at `now`."""
    view = _nodes_view(session, robot, roles, now)
    return [_node_parameters(view, id) for id in view.nodes]


def get_node_parameters(
    session: Session, robot: str, node: str, roles: Collection[UserRole], now: int
) -> NodeParameters:
    """Return one coordination node; NotFoundError if there is none of that id."""
    view = _nodes_view(session, robot, roles, now)
    if node not in view.nodes:
        help = f"there are: {', '.join(list(view.nodes)[:20])}"
        raise NotFoundError("there is no such coordination node", help=help)
    return _node_parameters(view, node)


def _nodes_view(session: Session, robot: str, roles: Collection[UserRole], now: int) -> _NodesView:
    snapshot = load_snapshot(session, robot)
    settings = active_settings(snapshot.row, now)
    effective_plan = EffectivePlan(snapshot.plan, settings).plan
    pairs = zip(planned_nodes(snapshot.plan), planned_nodes(effective_plan), strict=True)
    return _NodesView(
        nodes={node.id: (kind, node, changed) for (kind, node), (_, changed) in pairs},
        rows={row.node: row for row in coordination_nodes(session, snapshot.app.id)},
        planned_json=node_json(snapshot.plan),
        effective_json=node_json(effective_plan),
        settings=settings,
        roles=roles,
    )


def _node_parameters(view: _NodesView, id: str) -> NodeParameters:
    kind, node, changed = view.nodes[id]
    row = view.rows.get(id)
    last_violation = (
        describe_violation(changed, row.violation) if row and row.violation else Violation()
    )
    return NodeParameters(
        id=id,
        type=kind.value,
        description=row.description if row else "",
        mode=(Mode.OBSERVE if isinstance(node, FpsMonitor) else node.mode).value,
        topics=topics(node),
        trigger_time=row.triggered if row else None,
        violated_rule=last_violation.rule,
        violation_cause=last_violation.cause,
        violation_details=last_violation.details,
        risk_information=row.risk_information if row else {},
        plan=view.planned_json[id],
        effective=view.effective_json[id],
        settings=view.settings.nodes.get(id, NodeSettings()),
        policies=[policy.value for policy in _selectable_policies(node)],
        mandatory=list(_mandatory_names(node)),
        rights=sorted(granted_rights(view.roles, kind)),
        override=view.settings.overrides.get(id),
    )


def _selectable_policies(node: CoordinationNode) -> Collection[PolicyName]:
    """Return the policies that may be selected at a coordination node, as the plan has it."""
    if isinstance(node, GRCN):
        policies = (PolicyName.BLOCK,) if node.sharing is Sharing.MERGE else grcn.POLICIES
        return [each for each in policies if node.lease or each is not PolicyName.LEASE]
    if isinstance(node, RSRCN):
        must = {node.mandatory} - {None}
        return [each for each in rsrcn.POLICIES if must <= set(rsrcn.included_policies(each))]
    return msrcn.POLICIES if isinstance(node, MSRCN) else ()


def _mandatory_names(node: CoordinationNode) -> Iterator[str]:
    """Yield what the end user cannot take away: a policy, or rules."""
    if isinstance(node, RSRCN) and node.mandatory:
        yield node.mandatory.value
    if isinstance(node, MSRCN):
        yield from (rule.name for rule in node.rules if rule.mandatory)

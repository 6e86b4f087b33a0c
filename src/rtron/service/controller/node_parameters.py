"""A coordination node as the paper's console shows it: its risk model, and what may be set."""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from sqlalchemy.orm import Session

from rtron.planning.coherence import grcn, msrcn, rsrcn
from rtron.service.controller.robot_snapshot import find_known, unexpired
from rtron.service.domain.errors import NotFoundError
from rtron.service.domain.rights import rights
from rtron.service.domain.risk_model import Coordination, coordination, node_json, topics
from rtron.service.domain.schemas import NodeParameters, UserRole
from rtron.service.domain.violations import Violation, violation
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
    effective_plan,
)

_Json = Mapping[str, dict[str, Any]]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Page:
    """What the nodes of one robot are shown from, to somebody with these roles."""

    nodes: Mapping[str, tuple[CoordinationKind, Coordination, Coordination]]
    rows: Mapping[str, CoordinationNodeRow]
    planned: _Json
    in_force: _Json
    settings: Settings
    roles: Collection[UserRole]


def all_parameters(
    session: Session, robot: str, roles: Collection[UserRole], now: int
) -> list[NodeParameters]:
    """Return the coordination nodes of a robot, as somebody with these roles sees them at `now`."""
    page = _page(session, robot, roles, now)
    return [_parameters(page, id) for id in page.nodes]


def parameters(
    session: Session, robot: str, node: str, roles: Collection[UserRole], now: int
) -> NodeParameters:
    """Return one coordination node; NotFoundError if there is none of that id."""
    page = _page(session, robot, roles, now)
    if node not in page.nodes:
        help = f"there are: {', '.join(list(page.nodes)[:20])}"
        raise NotFoundError("there is no such coordination node", help=help)
    return _parameters(page, node)


def _page(session: Session, robot: str, roles: Collection[UserRole], now: int) -> _Page:
    known = find_known(session, robot)
    settings = unexpired(known.settings, now)
    after = effective_plan(known.plan, settings)
    pairs = zip(coordination(known.plan), coordination(after), strict=True)
    return _Page(
        nodes={node.id: (kind, node, changed) for (kind, node), (_, changed) in pairs},
        rows={row.node: row for row in coordination_nodes(session, known.app.id)},
        planned=node_json(known.plan),
        in_force=node_json(after),
        settings=settings,
        roles=roles,
    )


def _parameters(page: _Page, id: str) -> NodeParameters:
    kind, node, changed = page.nodes[id]
    row = page.rows.get(id)
    told = violation(changed, row.violation) if row and row.violation else Violation()
    return NodeParameters(
        id=id,
        type=kind.value,
        description=row.description if row else "",
        mode=(Mode.OBSERVE if isinstance(node, FpsMonitor) else node.mode).value,
        topics=topics(node),
        trigger_time=row.triggered if row else None,
        violated_rule=told.rule,
        violation_cause=told.cause,
        violation_details=told.details,
        risk_information=row.risk_information if row else {},
        plan=page.planned[id],
        effective=page.in_force[id],
        settings=page.settings.nodes.get(id, NodeSettings()),
        policies=[policy.value for policy in _policies(node)],
        mandatory=list(_mandatory(node)),
        rights=sorted(rights(page.roles, kind)),
        override=page.settings.overrides.get(id),
    )


def _policies(node: Coordination) -> Collection[PolicyName]:
    """Return the policies that may be selected at a coordination node, as the plan has it."""
    if isinstance(node, GRCN):
        return (PolicyName.BLOCK,) if node.sharing is Sharing.MERGE else grcn.POLICIES
    if isinstance(node, RSRCN):
        must = {node.mandatory} - {None}
        return [each for each in rsrcn.POLICIES if must <= set(rsrcn.included(each))]
    return msrcn.POLICIES if isinstance(node, MSRCN) else ()


def _mandatory(node: Coordination) -> Iterator[str]:
    """Yield what the end user cannot take away: a policy, or rules."""
    if isinstance(node, RSRCN) and node.mandatory:
        yield node.mandatory.value
    if isinstance(node, MSRCN):
        yield from (rule.name for rule in node.rules if rule.mandatory)

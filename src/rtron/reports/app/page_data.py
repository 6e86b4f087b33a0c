"""What the page knows: the graph, its risks and the plan, with numbers in place of names."""

from collections.abc import Iterable, Mapping
from typing import Any, TypeAlias

from rtron.reports.app.inventory_rows import rows_to_json
from rtron.reports.app.note_groups import NoteKind, group_notes
from rtron.reports.app.page_coordination import PageIds, page_ids, plan_data
from rtron.reports.app.risk_list import KIND_TITLE, RiskMarks, location, risk_marks, worst_first
from rtron.sanitize import sanitize
from rtron.vocabulary import (
    Direction,
    Endpoint,
    Evidence,
    Finding,
    InteractionGraph,
    Node,
    Plan,
    Risk,
    RiskKind,
    RiskReport,
    UnresolvedItem,
)
from rtron.vocabulary.inventory import Mover

SourceLines: TypeAlias = Mapping[Evidence, str]
NO_LINES: SourceLines = {}


def page_data(
    graph: InteractionGraph,
    report: RiskReport,
    plan: Plan | None,
    findings: Iterable[Finding] = (),
    source_lines: SourceLines = NO_LINES,
    inventory: Iterable[Mover] = (),
) -> Any:  # noqa: ANN401
    """Return all that the page shows as plain JSON, every text on one line and harmless."""
    names, colours = page_ids(graph, report, plan), risk_marks(graph, report)
    findings, inventory = tuple(findings), tuple(inventory)
    commands = (command.name for mover in inventory for command in mover.last_commands)
    named = {*commands, *(topic for finding in findings for topic in finding.topics)}
    document = {
        "app": graph.app or "app",
        "ros": graph.ros,
        "kinds": {kind.value: KIND_TITLE[kind] for kind in RiskKind},
        "nodes": _nodes(graph, names, colours),
        "topics": [
            {**topic, "isNamed": topic["name"] in named}
            for topic in _topics(graph, report, names, colours)
        ],
        "endpoints": [_endpoint(endpoint, names, colours) for endpoint in graph.endpoints],
        "services": [_side(names, s.node, s.name, s.type, "") for s in graph.services],
        "actions": [_side(names, a.node, a.name, a.type, a.role.value) for a in graph.actions],
        "risks": [_risk(risk, names) for risk in sorted(report.risks, key=worst_first)],
        "inventory": [rows_to_json(mover) for mover in inventory],
        "findings": [_finding(finding, names, source_lines) for finding in findings],
        "unresolved": [_note_group(*group) for group in group_notes(graph.unresolved)],
        "notRun": [list(item) for item in report.not_run.items()],
        "coordination": plan_data(plan, names) if plan else [],
    }
    return _harmless(document)


def _nodes(graph: InteractionGraph, names: PageIds, colours: RiskMarks) -> list[dict[str, Any]]:
    known = {node.name: node for node in graph.nodes}
    return [_node(known.get(name, Node(name=name)), colours) for name in names.nodes]


def _node(node: Node, colours: RiskMarks) -> dict[str, Any]:
    marks = {"image": colours.image_nodes, "max_vel": colours.max_vel_nodes}
    return {
        "name": node.name,
        "package": node.package,
        "executable": node.executable,
        "origin": node.origin,
        "trust": node.trust.value,
        "function": node.function.value if node.function else "",
        "domain": node.domain.value if node.domain else "",
        "marks": [mark for mark, nodes in marks.items() if node.name in nodes],
    }


def _topics(
    graph: InteractionGraph, report: RiskReport, names: PageIds, colours: RiskMarks
) -> list[dict[str, Any]]:
    declared = {topic.name: topic.types for topic in graph.topics}
    marks = {"event": colours.event_topics, "action": colours.action_topics}
    classes = report.topic_classes
    return [
        {
            "name": name,
            "types": _types(graph, name, declared.get(name, ())),
            "domain": classes[name].domain.value if name in classes else "",
            "sharing": classes[name].sharing.value if name in classes else "",
            "marks": [mark for mark, topics in marks.items() if name in topics],
        }
        for name in names.topics
    ]


def _types(graph: InteractionGraph, topic: str, declared: Iterable[str]) -> list[str]:
    used = (e.type for e in (*graph.publishers(topic), *graph.subscribers(topic)))
    return [name for name in dict.fromkeys((*declared, *used)) if name]


def _endpoint(endpoint: Endpoint, names: PageIds, colours: RiskMarks) -> dict[str, Any]:
    edge = (endpoint.node, endpoint.topic)
    marks = {RiskKind.GR_ST: colours.single_topic, RiskKind.GR_MT: colours.multi_topic}
    remapped = endpoint.declared_name not in ("", endpoint.topic)
    return {
        "node": names.nodes[endpoint.node],
        "topic": names.topics[endpoint.topic],
        "publishes": endpoint.direction is Direction.PUBLISH,
        "type": endpoint.type,
        "declared": endpoint.declared_name if remapped else "",
        "implicit": endpoint.implicit,
        "resolution": endpoint.resolution.value,
        "evidence": _locations(endpoint.evidence),
        "marks": [kind.value for kind, edges in marks.items() if edge in edges],
    }


def _side(names: PageIds, node: str, name: str, type: str, role: str) -> dict[str, Any]:
    return {"node": names.nodes[node], "name": name, "type": type, "role": role}


def _risk(risk: Risk, names: PageIds) -> dict[str, Any]:
    return {
        "id": risk.id,
        "kind": risk.kind.value,
        "rule": risk.rule,
        "roles": [[role.value, names.node_ids(nodes)] for role, nodes in risk.role_nodes.items()],
        "topics": names.topic_ids(risk.topics),
        "successors": names.node_ids(risk.successors),
        "type": risk.message_type,
        "domain": risk.domain.value,
        "severity": risk.severity.value,
        "reason": risk.reason,
        "evidence": _locations(risk.evidence),
    }


def _finding(finding: Finding, names: PageIds, source_lines: SourceLines) -> dict[str, Any]:
    """Return a finding with those of its nodes and topics that are in the graph."""
    return {
        "id": finding.id,
        "rule": finding.rule,
        "severity": finding.severity.value,
        "certainty": finding.certainty.value,
        "summary": finding.summary,
        "cause": finding.cause,
        "remedy": finding.remedy,
        "nodes": [names.nodes[node] for node in finding.nodes if node in names.nodes],
        "topics": [names.topics[topic] for topic in finding.topics if topic in names.topics],
        "evidence": _locations(finding.evidence),
        "lines": [source_lines.get(place, "") for place in finding.evidence],
    }


def _note_group(kind: NoteKind, notes: list[UnresolvedItem]) -> dict[str, Any]:
    return {"title": kind.title, "remedy": kind.remedy, "notes": list(map(_unresolved, notes))}


def _unresolved(item: UnresolvedItem) -> dict[str, Any]:
    return {"what": item.what, "why": item.why, "evidence": _locations(item.evidence)}


def _locations(evidence: Iterable[Evidence]) -> list[str]:
    return [location(item) for item in evidence]


def _harmless(value: Any) -> Any:  # noqa: ANN401 - plain JSON
    if isinstance(value, str):
        return sanitize(value)
    if isinstance(value, dict):
        return {key: _harmless(inner) for key, inner in value.items()}
    return [_harmless(inner) for inner in value] if isinstance(value, list) else value

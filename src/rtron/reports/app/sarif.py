"""Findings and risks as SARIF 2.1.0, for code scanning services and editors.

Findings stand first, the worst first, then risks in the order of kind, topics and id. A result's
fingerprint holds its rule, subject, topics and nodes, and no line: it stays when code moves or
unrelated nodes come and go.
"""

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from hashlib import sha256
from pathlib import Path, PurePosixPath
from posixpath import normpath
from typing import Any
from urllib.parse import quote

from rtron import __version__
from rtron.reports.app.inventory_rows import inventory_to_json
from rtron.reports.app.sarif_rules import finding_descriptors, rule_descriptors, rule_index
from rtron.sanitize import sanitize
from rtron.vocabulary import (
    Direction,
    Evidence,
    Finding,
    InteractionGraph,
    Risk,
    RiskReport,
    Severity,
    Triage,
    UnresolvedItem,
)
from rtron.vocabulary.inventory import Mover

SCHEMA = (
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
)
FINGERPRINT = "rtronRisk/v1"
FINDING_FINGERPRINT = "rtronFinding/v1"
_UNRESOLVED, _NOT_RUN = "unresolved", "rule-not-run"
_LEVEL: Mapping[Severity, str] = {
    Severity.HIGH: "error",
    Severity.MEDIUM: "warning",
    Severity.LOW: "note",
}
_VERB = {Direction.PUBLISH: "publishes", Direction.SUBSCRIBE: "subscribes"}
_Facts = Mapping[Evidence, str]


def risks_to_sarif(
    graph: InteractionGraph,
    report: RiskReport,
    root: Path | None,
    triage: Triage | None = None,
    inventory: Sequence[Mover] = (),
) -> str:
    """Return findings and risks as a SARIF document; locations below `root` are relative to it.

    The inventory stands in the properties of the run.
    """
    found = triage or Triage(findings=())
    run = {
        "tool": {"driver": _driver(found)},
        "automationDetails": {"id": f"rtron/{sanitize(report.app or 'app')}"},
        "invocations": [_invocation(graph, report, root)],
        "originalUriBaseIds": base_ids(root),
        "logicalLocations": list(_functions(graph)),
        "properties": {"inventory": inventory_to_json(inventory)},
        "results": [*_finding_results(graph, found, root), *_results(graph, report, root)],
    }
    return json.dumps({"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}, indent=2) + "\n"


def _functions(graph: InteractionGraph) -> Iterator[dict[str, Any]]:
    """Yield the nodes whose function is known, with it (SARIF 2.1.0 section 3.14.17)."""
    for node in graph.nodes:
        if node.function:
            [location] = logical_locations([node.name])
            domain = node.domain.value if node.domain else ""
            yield location | {"properties": {"function": node.function.value, "domain": domain}}


def _driver(triage: Triage) -> dict[str, Any]:
    return {
        "name": "RTron",
        "version": __version__,
        "semanticVersion": __version__,
        "rules": [*rule_descriptors(), *finding_descriptors(triage)],
        "notifications": [
            {"id": _UNRESOLVED, "shortDescription": {"text": "Something could not be read."}},
            {"id": _NOT_RUN, "shortDescription": {"text": "A rule could not run."}},
        ],
    }


def _invocation(graph: InteractionGraph, report: RiskReport, root: Path | None) -> dict[str, Any]:
    unresolved = sorted(graph.unresolved, key=_order_of_unresolved)
    notes = [_unresolved(item, root) for item in unresolved]
    notes += [_notification(_NOT_RUN, 1, f"{r}: {why}") for r, why in report.not_run.items()]
    return {"executionSuccessful": True, "toolExecutionNotifications": notes}


def _unresolved(item: UnresolvedItem, root: Path | None) -> dict[str, Any]:
    locations = [{"physicalLocation": physical_location(e, root)} for e in item.evidence if e.file]
    note = _notification(_UNRESOLVED, 0, f"{item.what}: {item.why}")
    return note | ({"locations": locations} if locations else {})


def _notification(id: str, index: int, text: str) -> dict[str, Any]:
    return {"descriptor": {"id": id, "index": index}, "level": "warning", "message": message(text)}


def _order_of_unresolved(item: UnresolvedItem) -> tuple[list[tuple[str, int]], str, str]:
    return [(e.file, e.line) for e in item.evidence], item.what, item.why


def _results(
    graph: InteractionGraph, report: RiskReport, root: Path | None
) -> list[dict[str, Any]]:
    facts = dict(_facts(graph))
    ordered = sorted(report.risks, key=lambda r: (rule_index(r.kind), r.topics, r.id))
    return [_result(risk, facts, root) for risk in ordered]


def _finding_results(
    graph: InteractionGraph, triage: Triage, root: Path | None
) -> Iterator[dict[str, Any]]:
    """Yield new findings, known ones, and those that are ignored (SARIF 3.27.24, 3.27.23)."""
    facts = dict(_facts(graph))
    states = {"baselineState": "new"}, {"baselineState": "unchanged"}
    new, unchanged = states if triage.known or triage.gone else ({}, {})
    for state, findings in ((new, triage.findings), (unchanged, triage.known)):
        for finding in findings:
            yield _finding_result(finding, facts, root, triage.folds.get(finding.id, "")) | state
    for finding, ignore in triage.ignored:
        kind = "inSource" if ignore.is_comment else "external"
        suppression = {"kind": kind, "justification": sanitize(ignore.reason)}
        yield _finding_result(finding, facts, root) | {"suppressions": [suppression]}


def _finding_result(
    finding: Finding, facts: _Facts, root: Path | None, folded_under: str = ""
) -> dict[str, Any]:
    """Return a result; `folded_under` is the finding that tells of this one in a text."""
    first, *others = _locations(finding.evidence, facts, root)
    related = [{"id": number} | location for number, location in enumerate(others, start=1)]
    text = f"{finding.summary}: {finding.cause}. Remedy: {finding.remedy}"
    return {
        "ruleId": finding.rule,
        "level": _LEVEL[finding.severity],
        "message": message(text),
        "locations": [first | {"logicalLocations": logical_locations(finding.nodes)}],
        "relatedLocations": related,
        "partialFingerprints": {FINDING_FINGERPRINT: finding.fingerprint},
        "properties": {
            "id": sanitize(finding.id),
            "severity": finding.severity.value,
            "certainty": finding.certainty.value,
            "consequence": finding.consequence.value,
            "topics": [sanitize(topic) for topic in finding.topics],
            **({"foldedUnder": sanitize(folded_under)} if folded_under else {}),
        },
    }


def _facts(graph: InteractionGraph) -> Iterator[tuple[Evidence, str]]:
    """Yield in words what was read where."""
    for endpoint in graph.endpoints:
        text = f"{endpoint.node} {_VERB[endpoint.direction]} {endpoint.topic}"
        yield from ((evidence, text) for evidence in endpoint.evidence)


def _result(risk: Risk, facts: _Facts, root: Path | None) -> dict[str, Any]:
    first, *others = _locations(risk.evidence, facts, root)
    related = [{"id": number} | location for number, location in enumerate(others, start=1)]
    return {
        "ruleId": risk.kind.value,
        "ruleIndex": rule_index(risk.kind),
        "level": _LEVEL[risk.severity],
        "message": message(risk.reason),
        "locations": [first | {"logicalLocations": logical_locations(_high_risk_nodes(risk))}],
        "relatedLocations": related,
        "partialFingerprints": {FINGERPRINT: _fingerprint(risk)},
        "properties": _properties(risk),
    }


def _locations(
    evidence: Iterable[Evidence], facts: _Facts, root: Path | None
) -> list[dict[str, Any]]:
    """Return the locations of the evidence; one without a location where there is none."""
    locations = [_location(e, facts, root) for e in dict.fromkeys(evidence) if e.file]
    return locations or [{}]


def _location(evidence: Evidence, facts: _Facts, root: Path | None) -> dict[str, Any]:
    text = {"message": message(facts[evidence])} if evidence in facts else {}
    return {"physicalLocation": physical_location(evidence, root)} | text


def _high_risk_nodes(risk: Risk) -> Sequence[str]:
    return sorted({node for nodes in risk.role_nodes.values() for node in nodes})


def _fingerprint(risk: Risk) -> str:
    roles = {role.value: sorted(nodes) for role, nodes in risk.role_nodes.items()}
    identity = [risk.kind.value, risk.rule, risk.id, sorted(risk.topics), roles]
    return sha256(json.dumps(identity, sort_keys=True).encode()).hexdigest()


def _properties(risk: Risk) -> dict[str, Any]:
    return {
        "id": sanitize(risk.id),
        "rule": risk.rule,
        "severity": risk.severity.value,
        "domain": risk.domain.value,
        "messageType": sanitize(risk.message_type),
        "topics": [sanitize(topic) for topic in risk.topics],
        "successors": [sanitize(node) for node in risk.successors],
    }


BASE = "SRCROOT"
_ADDRESSES = ("http://", "https://")
_PUBLIC = "github.com/"


def physical_location(evidence: Evidence, root: Path | None) -> dict[str, Any]:
    """Return a physicalLocation (SARIF 2.1.0 section 3.29); a line of 0 has no region."""
    location: dict[str, Any] = {"artifactLocation": _artifact(evidence.file, root)}
    if evidence.line > 0:
        location["region"] = {"startLine": evidence.line}
    return location


def logical_locations(nodes: Iterable[str]) -> list[dict[str, Any]]:
    """Return a logicalLocation for each node (SARIF 2.1.0 section 3.33)."""
    return [{"fullyQualifiedName": sanitize(node), "kind": "node"} for node in nodes]


def message(text: str) -> dict[str, Any]:
    """Return a plain message in which a stranger's brackets make no link (section 3.11.6)."""
    escaped = sanitize(text)
    for character in "\\[]":
        escaped = escaped.replace(character, f"\\{character}")
    return {"text": escaped}


def base_ids(root: Path | None) -> dict[str, Any]:
    """Return what the relative URIs are relative to; where `root` is relative, only in words."""
    if root is None:
        return {}
    base: dict[str, Any] = {"description": {"text": "The folder that was scanned."}}
    if root.is_absolute():
        base["uri"] = _file_uri(normpath(root.as_posix()).rstrip("/") + "/")
    return {BASE: base}


def _artifact(file: str, root: Path | None) -> dict[str, str]:
    if file.startswith(_PUBLIC):
        return {"uri": "https://" + quote(file, safe="/:@?&=%[]", errors="replace")}
    if file.lower().startswith(_ADDRESSES):
        return {"uri": quote(file, safe="/:@?&=%[]", errors="replace")}
    path = PurePosixPath(normpath(file))
    if root is not None:
        base = PurePosixPath(normpath(root.as_posix()))
        if path.is_relative_to(base) and ".." not in path.relative_to(base).parts:
            return {"uri": _quoted(str(path.relative_to(base))), "uriBaseId": BASE}
    return {"uri": _file_uri(str(path)) if path.is_absolute() else _quoted(str(path))}


def _file_uri(path: str) -> str:
    return f"file:///{_quoted(path.lstrip('/'))}"


def _quoted(path: str) -> str:
    return quote(path, errors="replace")

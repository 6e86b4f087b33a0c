"""Risks and findings as JSON, schema `rtron.risks/2`."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from rtron.reports.app.inventory_rows import inventory_to_json
from rtron.vocabulary import (
    RISKS_SCHEMA,
    CoordinationCount,
    Domain,
    Evidence,
    Finding,
    Ignore,
    Risk,
    RiskKind,
    RiskReport,
    Triage,
)
from rtron.vocabulary.inventory import Mover

_ALWAYS_COUNTED = (Domain.PERCEPTION, Domain.PLANNING, Domain.CONTROL)


def risks_to_json(
    report: RiskReport, triage: Triage | None = None, inventory: Sequence[Mover] = ()
) -> dict[str, Any]:
    """Return the report as a JSON document; counts of zero stand, except of the lesser domains."""
    kinds = Counter(risk.kind for risk in report.risks)
    return {
        "schema": RISKS_SCHEMA,
        "app": report.app,
        "inventory": inventory_to_json(inventory),
        **_triage(triage or Triage(findings=())),
        "risks": [_risk(risk) for risk in report.risks],
        "summary": {kind.value: kinds[kind] for kind in RiskKind},
        "coordination_nodes": _coordination(report.coordination_nodes),
        "not_run": dict(report.not_run),
    }


def _triage(triage: Triage) -> dict[str, Any]:
    """Return the findings, all but the ignored ones in one list: new ones and known ones.

    `folded_under` is the id of the finding that tells of this one in a text, if there is one.
    """
    return {
        "findings": [
            _finding(finding) | {"is_new": is_new, "folded_under": triage.folds.get(finding.id, "")}
            for is_new, findings in ((True, triage.findings), (False, triage.known))
            for finding in findings
        ],
        "ignored": [_ignored(finding, ignore) for finding, ignore in triage.ignored],
        "gone": list(triage.gone),
        "unused_ignores": [_ignore(ignore) for ignore in triage.unused],
    }


def _ignored(finding: Finding, ignore: Ignore) -> dict[str, Any]:
    return {"finding": _finding(finding), **_ignore(ignore)}


def _ignore(ignore: Ignore) -> dict[str, Any]:
    return {
        "rule": ignore.rule,
        "topic": ignore.topic,
        "reason": ignore.reason,
        "place": _evidence(ignore.place),
    }


def _finding(finding: Finding) -> dict[str, Any]:
    return {
        "id": finding.id,
        "rule": finding.rule,
        "fingerprint": finding.fingerprint,
        "severity": finding.severity.value,
        "certainty": finding.certainty.value,
        "consequence": finding.consequence.value,
        "level": finding.level.value,
        "subject": finding.subject,
        "summary": finding.summary,
        "cause": finding.cause,
        "remedy": finding.remedy,
        "nodes": list(finding.nodes),
        "topics": list(finding.topics),
        "evidence": [_evidence(evidence) for evidence in finding.evidence],
    }


def _risk(risk: Risk) -> dict[str, Any]:
    return {
        "id": risk.id,
        "kind": risk.kind.value,
        "rule": risk.rule,
        "role_nodes": {role.value: list(nodes) for role, nodes in risk.role_nodes.items()},
        "topics": list(risk.topics),
        "message_type": risk.message_type,
        "successors": list(risk.successors),
        "domain": risk.domain.value,
        "severity": risk.severity.value,
        "reason": risk.reason,
        "one_to_one": risk.one_to_one,
        "evidence": [_evidence(evidence) for evidence in risk.evidence],
    }


def _evidence(evidence: Evidence) -> dict[str, Any]:
    return {"file": evidence.file, "line": evidence.line}


def _coordination(count: CoordinationCount) -> dict[str, Any]:
    return {
        "GRCN": _by_domain(count.grcn),
        "fps_monitor": count.fps_monitor,
        "RSRCN": count.rsrcn,
        "MSRCN": count.msrcn,
    }


def _by_domain(numbers: Mapping[Domain, int]) -> dict[str, int]:
    shown = [domain for domain in Domain if domain in _ALWAYS_COUNTED or numbers.get(domain)]
    return {domain.value: numbers.get(domain, 0) for domain in shown}

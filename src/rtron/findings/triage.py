"""Which findings of a scan are news: neither ignored with a reason nor known from an earlier scan.

The paper's risks follow: one is no news where it is known, or ignored by its own rule, or where all
its topics are those of findings that are ignored.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from itertools import chain

from rtron.findings.folding import folds
from rtron.findings.severity import shown_at
from rtron.vocabulary import (
    Baseline,
    Finding,
    FindingLevel,
    Ignore,
    InteractionGraph,
    Risk,
    Triage,
    Trust,
)


def triage(
    graph: InteractionGraph,
    findings: Sequence[Finding],
    risks: Sequence[Risk],
    ignores: Sequence[Ignore] = (),
    baseline: Baseline | None = None,
) -> Triage:
    """Return what is news.

    A comment ignores findings that name nodes, all of them the user's own: else a stranger's code
    could silence what is found about it.
    """
    earlier = baseline or Baseline()
    own = {node.name for node in graph.nodes if node.trust is Trust.OWN}
    applied = {finding.id: _applying(ignores, finding, own) for finding in findings}
    ignored = [(each, applied[each.id][0]) for each in findings if applied[each.id]]
    others = [each for each in findings if not applied[each.id]]
    used = {id(ignore) for ignore in chain.from_iterable(applied.values())}
    used |= {id(each) for each in ignores if any(_ignores_risk(each, risk) for risk in risks)}
    settled = {topic for finding, _ in ignored for topic in finding.topics}
    found = {finding.fingerprint for finding in findings}
    news = tuple(each for each in others if each.fingerprint not in earlier.findings)
    known = tuple(each for each in others if each.fingerprint in earlier.findings)
    return Triage(
        findings=news,
        risks=tuple(
            risk
            for risk in risks
            if risk.id not in earlier.risks
            and not settled.issuperset(risk.topics)
            and not any(_ignores_risk(each, risk) for each in ignores)
        ),
        ignored=tuple(ignored),
        known=known,
        gone=tuple(id for print_, id in earlier.findings.items() if print_ not in found),
        unused=tuple(each for each in ignores if id(each) not in used),
        folds=folds(news) | folds(known),
    )


def at_level(triage: Triage, level: FindingLevel) -> Triage:
    """Return what a level shows: its findings, new and known ones; to auditors also the risks."""
    shown, known = (
        tuple(finding for finding in each if shown_at(level, finding))
        for each in (triage.findings, triage.known)
    )
    risks = triage.risks if level is FindingLevel.AUDITOR else ()
    return replace(triage, findings=shown, known=known, risks=risks)


def _applying(ignores: Iterable[Ignore], finding: Finding, own: set[str]) -> list[Ignore]:
    """Return the ignores that mean a finding, the first of them being the one in force."""
    is_own = bool(finding.nodes) and own.issuperset(finding.nodes)
    return [
        each
        for each in ignores
        if each.rule == finding.rule
        and _matches(each, (finding.subject, *finding.topics))
        and (not each.is_comment or (is_own and _is_beside(each, finding)))
    ]


def _ignores_risk(ignore: Ignore, risk: Risk) -> bool:
    is_meant = not ignore.is_comment and ignore.rule == risk.rule
    return is_meant and all(_matches(ignore, [topic]) for topic in risk.topics)


def _matches(ignore: Ignore, names: Iterable[str]) -> bool:
    return any(fnmatchcase(name, ignore.topic) for name in names)


def _is_beside(comment: Ignore, finding: Finding) -> bool:
    """Return whether a comment stands in a line of the evidence, or in the one before."""
    lines = (comment.place.line, comment.place.line + 1)
    return any(e.file == comment.place.file and e.line in lines for e in finding.evidence)

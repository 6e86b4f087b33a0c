"""The risks of a report by kind, the worst first; mild ones in short."""

from collections.abc import Iterator, Mapping, Sequence

from rich.text import Text

from rtron.reports.text_layout import TextPage, heading, line, paragraph
from rtron.vocabulary import Evidence, Risk, RiskKind, RiskReport, Severity

SEVERITY_STYLE: Mapping[Severity, str] = {
    Severity.HIGH: "bold red",
    Severity.MEDIUM: "yellow",
    Severity.LOW: "cyan",
}
KIND_TITLE: Mapping[RiskKind, str] = {
    RiskKind.GR_ST: "several nodes publish one topic",
    RiskKind.GR_MT: "one node obeys several topics of one type",
    RiskKind.RSR: "the robot may move faster than it sees",
    RiskKind.MSR: "an action may be taken under the wrong event",
}
_LOCATIONS_SHOWN: Mapping[Severity, int] = {Severity.HIGH: 3, Severity.MEDIUM: 1, Severity.LOW: 0}
_INDENT = 10
MILDEST_LAST: tuple[Severity, ...] = tuple(reversed(Severity))


def worst_first(risk: Risk) -> int:
    """Return a sort key that puts high before medium before low."""
    return MILDEST_LAST.index(risk.severity)


def risk_list(report: RiskReport, page: TextPage) -> Iterator[Text]:
    """Yield the risks that have no drawing: each with its reason and where it was read."""
    for kind in RiskKind:
        risks = [risk for risk in report.risks if risk.kind is kind is not RiskKind.GR_ST]
        if risks:
            yield from heading(f"{kind}: {KIND_TITLE[kind]} ({len(risks)})")
        for risk in sorted(risks, key=worst_first):
            yield from _risk(risk, page)


def severity_mark(risk: Risk) -> tuple[str, str]:
    """Return the severity in its column and its style."""
    return f"{risk.severity:<8}", SEVERITY_STYLE[risk.severity]


def evidence_lines(risk: Risk, *, indent: int) -> Iterator[Text]:
    """Yield where a risk was read, more places the worse it is, and how many are left out."""
    shown = risk.evidence[: _LOCATIONS_SHOWN[risk.severity]]
    more = len(risk.evidence) - len(shown)
    for index, evidence in enumerate(shown, start=1):
        rest = f" and {more} more" if more and index == len(shown) else ""
        yield line((location(evidence) + rest, "dim"), indent=indent)


def location(evidence: Evidence) -> str:
    """Return `file:line`, which editors and terminals open."""
    return f"{evidence.file}:{evidence.line}" if evidence.line else evidence.file


def _risk(risk: Risk, page: TextPage) -> Iterator[Text]:
    yield line(severity_mark(risk), (risk.id, "bold"), ("  " + risk.domain, "dim"), indent=2)
    if risk.severity is Severity.LOW:
        return
    yield from paragraph(risk.reason, page, indent=_INDENT)
    yield from _unnamed(risk, page)
    yield from evidence_lines(risk, indent=_INDENT)


def _unnamed(risk: Risk, page: TextPage) -> Iterator[Text]:
    """Yield the nodes of each role where the reason does not name them all."""
    for role, nodes in risk.role_nodes.items():
        if not _names_all(risk.reason, nodes):
            yield from paragraph(f"{role}: {', '.join(nodes)}", page, indent=_INDENT)


def _names_all(reason: str, nodes: Sequence[str]) -> bool:
    words = {word.strip(",:;.") for word in reason.split()}
    return words.issuperset(nodes)

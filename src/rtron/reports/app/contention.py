"""Who can interfere with whom: each topic that several nodes publish, drawn as a small flow."""

from collections.abc import Iterator

from rich.text import Text

from rtron.reports.app.flow_drawing import Flow, draw
from rtron.reports.app.risk_list import evidence_lines, severity_mark
from rtron.reports.app.risk_words import KIND_TITLE, SEVERITY_STYLE, worst_first
from rtron.reports.text_layout import Page, heading, line
from rtron.vocabulary import InteractionGraph, Risk, RiskKind, RiskReport, Role, Trust

_INDENT = 10


def contention(graph: InteractionGraph, report: RiskReport, page: Page) -> Iterator[Text]:
    """Yield a drawing for each risk of GR-ST, the worst first; nothing where there is none."""
    contended = [risk for risk in report.risks if risk.kind is RiskKind.GR_ST]
    if not contended:
        return
    foreign = frozenset(n.name for n in graph.nodes if n.trust is Trust.THIRD_PARTY)
    title = f"{RiskKind.GR_ST}: {KIND_TITLE[RiskKind.GR_ST]} ({len(contended)})"
    yield from heading("Who can interfere with whom")
    yield line(title, indent=2)
    for risk in sorted(contended, key=worst_first):
        yield _title(risk, report)
        yield from _drawings(risk, foreign, page)
        yield from evidence_lines(risk, indent=_INDENT)


def _title(risk: Risk, report: RiskReport) -> Text:
    sharing = [
        str(report.topic_classes[topic].sharing)
        for topic in risk.topics
        if topic in report.topic_classes
    ]
    said = ", ".join((risk.message_type, str(risk.domain), *sharing))
    return line(severity_mark(risk), said, indent=2)


def _drawings(risk: Risk, foreign: frozenset[str], page: Page) -> Iterator[Text]:
    publishers = risk.role_nodes.get(Role.PUBLISHER, ())
    for topic in risk.topics:
        flow = Flow(
            publishers=tuple(_marked(name, foreign) for name in publishers),
            topic=topic,
            successors=risk.successors,
            style=SEVERITY_STYLE[risk.severity],
        )
        yield from draw(flow, page, indent=_INDENT)


def _marked(name: str, foreign: frozenset[str]) -> str:
    return f"{name} (third party)" if name in foreign else name

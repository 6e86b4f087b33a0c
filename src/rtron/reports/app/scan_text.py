"""What a scan found, as text for a person at a terminal."""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain

from rich.text import Text

from rtron.reports.app.contention import contention
from rtron.reports.app.inventory_rows import Tone, mover_rows
from rtron.reports.app.node_endpoints import node_functions
from rtron.reports.app.risk_list import MILDEST_LAST, SEVERITY_STYLE, location, risk_list
from rtron.reports.app.unresolved_list import missing_inputs, nodes_read, unresolved_list
from rtron.reports.text_layout import Report, TextPage, columns, counted, heading, line, paragraph
from rtron.vocabulary import (
    CoordinationCount,
    CoordinationKind,
    Domain,
    Finding,
    FindingLevel,
    InteractionGraph,
    RiskReport,
    Triage,
)
from rtron.vocabulary.inventory import Mover

_INDENT = 18
_TONE_STYLE = {Tone.PLAIN: "", Tone.GOOD: "green", Tone.WARNING: "yellow", Tone.UNCERTAIN: "dim"}


@dataclass(frozen=True, slots=True)
class Scan:
    """A scan to report: the graph, where it was read from, what was found, and what to do next.

    `triage` has the findings of `level`, `hidden` are the others. `guess` is what was guessed.
    """

    graph: InteractionGraph
    report: RiskReport
    triage: Triage
    read_from: str
    next_step: str
    hidden: tuple[Finding, ...] = ()
    level: FindingLevel = FindingLevel.REGULAR
    guess: str = ""
    inventory: tuple[Mover, ...] = ()


def scan_text(scan: Scan) -> Report:
    """Return the report of a scan."""
    return Report(lambda page: _lines(scan, page))


def _lines(scan: Scan, page: TextPage) -> Iterable[Text]:
    return chain(
        _header(scan, page),
        inventory_list(scan.inventory, page, is_whole=not scan.graph.unresolved),
        _verdict(scan),
        finding_list(scan.triage.findings, page),
        triage_notes(scan.triage, page),
        _paper_risks(scan, page) if scan.level is FindingLevel.AUDITOR else (),
        _not_run(scan.report, page),
        unresolved_list(scan.graph.unresolved, page),
        _next_step(scan),
    )


def _paper_risks(scan: Scan, page: TextPage) -> Iterator[Text]:
    """Yield what the paper's algorithms find, complete."""
    yield from heading("The paper's risks")
    yield _risk_verdict(scan)
    yield from contention(scan.graph, scan.report, page)
    yield from risk_list(scan.report, page)
    yield from node_functions(scan.graph.nodes, page)
    yield from _coordination(scan.report)


def _header(scan: Scan, page: TextPage) -> Iterator[Text]:
    graph = scan.graph
    yield line((graph.app or "app", "bold"), f"  ROS {graph.ros}, read from {scan.read_from}")
    counts = {
        "node": len(graph.nodes),
        "topic": len(graph.topics),
        "endpoint": len(graph.endpoints),
        "service": len(graph.services),
        "action endpoint": len(graph.actions),
    }
    summary = ", ".join(counted(number, noun) for noun, number in counts.items() if number)
    yield from paragraph(summary or "the graph is empty", page)
    unread = nodes_read(graph)
    yield from paragraph(unread, page, style="yellow") if unread else ()
    for missing in missing_inputs(graph):
        yield from paragraph(missing, page, style="yellow")
    yield from paragraph(scan.guess, page, style="dim") if scan.guess else ()


def inventory_list(movers: Sequence[Mover], page: TextPage, *, is_whole: bool) -> Iterator[Text]:
    """Yield each thing that can be moved, or that nothing moves."""
    yield from heading("What can move this robot")
    if not movers:
        partly = "" if is_whole else " in what could be read, see below"
        yield from paragraph(f"nothing{partly}", page, indent=2)
    for mover in movers:
        first, *others = _mover_lines(mover, page)
        mark = (f"{mover.thing:<{_INDENT - 2}}", "bold")
        yield line(mark, indent=2).append_text(first[_INDENT:])
        yield from others


def _mover_lines(mover: Mover, page: TextPage) -> list[Text]:
    return [
        text
        for row in mover_rows(mover)
        for text in paragraph(row.text, page, indent=_INDENT, style=_TONE_STYLE[row.tone])
    ]


def _verdict(scan: Scan) -> Iterator[Text]:
    yield from heading("Findings")
    is_whole = not scan.graph.unresolved
    yield findings_verdict(scan.triage.findings, scan.hidden, is_whole=is_whole)


def _risk_verdict(scan: Scan) -> Text:
    if not scan.report.risks:
        partly = " in what could be read" if scan.graph.unresolved or scan.report.not_run else ""
        return line((f"no risks found{partly}", "bold green"))
    numbers = Counter(risk.severity for risk in scan.report.risks)
    severities = [
        Text(f"{numbers[severity]} {severity}", SEVERITY_STYLE[severity])
        for severity in MILDEST_LAST
        if numbers[severity]
    ]
    return line((counted(len(scan.report.risks), "risk"), "bold"), ": ") + Text(", ").join(
        severities
    )


def _coordination(report: RiskReport) -> Iterator[Text]:
    if report.risks:
        yield from heading("Coordination nodes needed")
        yield from columns(_needed(report.coordination_nodes), indent=2)


def _needed(count: CoordinationCount) -> list[tuple[str, ...]]:
    domains = ", ".join(
        f"{domain} {count.grcn[domain]}" for domain in Domain if count.grcn.get(domain)
    )
    return [
        (CoordinationKind.GRCN, f"{sum(count.grcn.values()):>3}", domains),
        (CoordinationKind.RSRCN, f"{count.rsrcn:>3}", ""),
        (CoordinationKind.MSRCN, f"{count.msrcn:>3}", ""),
        (CoordinationKind.FPS_MONITOR, f"{count.fps_monitor:>3}", ""),
    ]


def _not_run(report: RiskReport, page: TextPage) -> Iterator[Text]:
    if report.not_run:
        yield from heading("Rules not run")
    for rule, why in report.not_run.items():
        yield from paragraph(f"{rule}: {why}", page, indent=2)


def _next_step(scan: Scan) -> Iterator[Text]:
    if scan.triage.findings or scan.report.risks:
        yield from heading("Next")
        yield line((scan.next_step, "bold green"), "  propose what to put in between", indent=2)
    if scan.triage.findings:
        page = f"rtron explain {scan.triage.findings[0].rule}"
        yield line((page, "bold green"), "  why it matters", indent=2)


_FINDING_INDENT = 10


def finding_list(findings: Sequence[Finding], page: TextPage) -> Iterator[Text]:
    """Yield each finding: what can happen, what makes it so, where, and what to do."""
    for finding in findings:
        yield Text()
        yield from _summary(finding, page)
        yield from paragraph(finding.cause, page, indent=_FINDING_INDENT)
        yield from paragraph(_places(finding), page, indent=_FINDING_INDENT, style="dim")
        yield from paragraph(f"-> {finding.remedy}", page, indent=_FINDING_INDENT, style="green")


def _places(finding: Finding) -> str:
    """Return the first place, how many there are, and the rule with its certainty."""
    places = [location(each) for each in finding.evidence[:1]]
    more = [f"and {len(finding.evidence) - 1} more"] if len(finding.evidence) > 1 else []
    return " ".join([*places, *more, f"({finding.rule}, {finding.certainty})"])


def triage_notes(triage: Triage, page: TextPage) -> Iterator[Text]:
    """Yield what is not shown as news: ignored and known findings, and those that are gone."""
    if triage.ignored or triage.unused:
        yield from heading("Ignored")
    for finding, ignore in triage.ignored:
        text = f"{finding.id}: {ignore.reason} ({location(ignore.place)})"
        yield from paragraph(text, page, indent=2)
    for ignore in triage.unused:
        text = f"nothing is found to ignore by {ignore.rule} {ignore.topic}, remove it"
        place = f" ({location(ignore.place)})"
        yield from paragraph(text + place, page, indent=2, style="yellow")
    if triage.known or triage.gone:
        yield from heading("Since the baseline")
        yield from paragraph(f"{len(triage.known)} known, not shown", page, indent=2)
    for id in triage.gone:
        yield from paragraph(f"gone: {id}", page, indent=2, style="green")


def _summary(finding: Finding, page: TextPage) -> Iterator[Text]:
    """Yield what can happen, the severity before its first row."""
    first, *others = paragraph(finding.summary, page, indent=_FINDING_INDENT, style="bold")
    mark = (f"{finding.severity:<8}", SEVERITY_STYLE[finding.severity])
    yield line(mark, indent=2).append_text(first[_FINDING_INDENT:])
    yield from others


def findings_verdict(
    shown: Sequence[Finding], hidden: Sequence[Finding], *, is_whole: bool
) -> Text:
    """Return how many findings there are, by severity, and how to see those that are not shown."""
    numbers = Counter(finding.severity for finding in shown)
    severities = [
        Text(f"{numbers[severity]} {severity}", SEVERITY_STYLE[severity])
        for severity in MILDEST_LAST
        if numbers[severity]
    ]
    partly = "" if is_whole else " in what could be read, see below"
    verdict = line((counted(len(shown), "finding") if shown else f"no findings{partly}", "bold"))
    if severities:
        verdict.append(": ").append_text(Text(", ").join(severities))
    if hidden:
        level = min((each.level for each in hidden), key=list(FindingLevel).index)
        verdict.append(f"; {len(hidden)} more from --level {level} on", "dim")
    return verdict

"""The findings of a scan as text: each in at most four lines, the worst first."""

from collections import Counter
from collections.abc import Iterator, Sequence

from rich.text import Text

from rtron.reports.app.risk_list import MILDEST_LAST, SEVERITY_STYLE, location
from rtron.reports.text_layout import TextPage, counted, heading, line, paragraph
from rtron.vocabulary import Finding, FindingLevel, Triage

_INDENT = 10


def finding_list(findings: Sequence[Finding], page: TextPage) -> Iterator[Text]:
    """Yield each finding: what can happen, what makes it so, where, and what to do."""
    for finding in findings:
        yield Text()
        yield from _summary(finding, page)
        yield from paragraph(finding.cause, page, indent=_INDENT)
        yield from paragraph(_places(finding), page, indent=_INDENT, style="dim")
        yield from paragraph(f"-> {finding.remedy}", page, indent=_INDENT, style="green")


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
    first, *others = paragraph(finding.summary, page, indent=_INDENT, style="bold")
    mark = (f"{finding.severity:<8}", SEVERITY_STYLE[finding.severity])
    yield line(mark, indent=2).append_text(first[_INDENT:])
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

"""What every rule of findings is: a name, a title, and one pure function from facts to findings."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from importlib import import_module

from rtron.findings.app_facts import AppFacts
from rtron.findings.severity import level_of, severity_of
from rtron.vocabulary import Certainty, Consequence, Evidence, Finding, FindingLevel


@dataclass(frozen=True, slots=True, kw_only=True)
class FindingRule:
    """One kind of finding; its module's docstring is its page, and its name the file's."""

    name: str
    title: str
    consequence: str
    since: str
    check: Callable[[AppFacts], Iterator[Finding]]


def make_finding(  # noqa: PLR0913 - a finding has so many parts, all by keyword
    rule: str,
    subject: str,
    *,
    summary: str,
    cause: str,
    remedy: str,
    consequence: Consequence,
    certainty: Certainty,
    level: FindingLevel | None = None,
    only_own_nodes: bool = False,
    meant: str = "",
    nodes: Iterable[str] = (),
    topics: Iterable[str] = (),
    evidence: Iterable[Evidence] = (),
) -> Finding:
    """Return a finding, its severity by the table, its level by the severity if none is given."""
    severity = severity_of(consequence, certainty, only_own_nodes=only_own_nodes)
    return Finding(
        rule=rule,
        subject=subject,
        summary=summary,
        cause=cause,
        remedy=remedy,
        consequence=consequence,
        certainty=certainty,
        severity=severity,
        level=level or level_of(severity),
        meant=meant,
        nodes=tuple(dict.fromkeys(nodes)),
        topics=tuple(dict.fromkeys(topics)),
        evidence=tuple(dict.fromkeys(evidence)),
    )


def finding_page(rule: FindingRule) -> str:
    """Return a rule's page in Markdown: its title, its facts and its module's docstring."""
    docstring = import_module(rule.check.__module__).__doc__ or ""
    summary, text = docstring.strip().split("\n", 1)
    subtitle = "" if summary.rstrip(".") == rule.title else f"{summary}\n\n"
    return (
        f"# {rule.title}\n\n{subtitle}"
        f"| rule | consequence | since |\n|---|---|---|\n"
        f"| `{rule.name}` | {rule.consequence} | {rule.since} |\n"
        f"{text}\n"
    )

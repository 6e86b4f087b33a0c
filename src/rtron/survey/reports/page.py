"""A survey as one HTML file: the paper's tables beside its own, drawn, and a line for each app.

Like the page of an app it needs no network and allows none. Every figure links to the apps that it
counts, and each app's line opens its worst risks and findings with their places.
"""

from collections import Counter
from collections.abc import Iterator, Mapping
from string import Template
from typing import Any

from rtron.functions.domains import DOMAIN_BY_TYPE
from rtron.reports.inline_page import inline_json, page_text, policy
from rtron.reports.text_layout import counted
from rtron.sanitize import sanitize
from rtron.survey.app_survey import AppResult, AppSurvey, FunctionLink
from rtron.survey.paper import RISKS_OF_COMPLEX_APPS
from rtron.survey.reports import page_sections as sections
from rtron.survey.reports.page_figures import row, table, text
from rtron.survey.reports.page_graph import graph_picture
from rtron.survey.statistics import counts_by_ros
from rtron.survey.survey_run import Survey
from rtron.vocabulary import Domain, RiskKind

_MOST_LISTED = 5
"""Risks and findings of an app in the page, each; `rtron scan` has all."""
_MOST_REASONS = 40


def survey_page(survey: Survey) -> str:
    """Return the page of a survey."""
    counts = counts_by_ros(survey.results)
    program, style = page_text("survey.js"), page_text("survey.css")
    return Template(page_text("survey.html")).substitute(
        policy=policy((program,), style),
        style=style,
        program=program,
        summary="\n".join(f"<p>{text(each)}</p>" for each in _summary(survey)),
        categories=sections.category_section(counts),
        risks=sections.risk_section(counts),
        complex_risks=RISKS_OF_COMPLEX_APPS,
        complex=sections.complex_section(counts),
        interactions=sections.interaction_section(counts),
        matrix=sections.matrix_section(counts),
        picture=graph_picture(counts[0]),
        generations=sections.generation_section(counts),
        changes=sections.change_section(counts),
        findings=sections.finding_section(counts),
        left_out=_left_out(survey),
        data=inline_json(_page_data(survey)),
    )


def _summary(survey: Survey) -> Iterator[str]:
    repositories = {result.repository for result in survey.results}
    scanned = sum(result.survey is not None for result in survey.results)
    failed = len(survey.results) - scanned
    yield (
        f"{counted(scanned, 'app')} of {len(repositories)} repositories: launch files that no "
        f"other includes and that need no arguments. {counted(failed, 'more app')} could not be "
        f"scanned; {len(survey.left_out)} launch files are no apps by themselves."
    )
    if survey.missing:
        yield f"{counted(survey.missing, 'app')} more: the survey was ended before."


def _page_data(survey: Survey) -> dict[str, Any]:
    return {
        "kinds": [str(kind) for kind in RiskKind],
        "apps": [_app_data(result) for result in survey.results],
    }


def _app_data(result: AppResult) -> Mapping[str, Any]:
    head = {"app": sanitize(result.app), "ros": result.ros, "seconds": result.seconds}
    if result.survey is None:
        return {**head, "error": sanitize(result.error)}
    return {**head, **_survey_data(result.survey)}


def _survey_data(survey: AppSurvey) -> Mapping[str, Any]:
    risks = survey.listed_risks[:_MOST_LISTED]
    findings = survey.listed_findings[:_MOST_LISTED]
    return {
        "nodes": survey.nodes,
        "topics": survey.topics,
        "risks": [survey.risks.get(kind, 0) for kind in RiskKind],
        "categories": list(survey.profile.categories),
        "functions": {str(name): len(nodes) for name, nodes in survey.profile.functions.items()},
        "links": list(dict.fromkeys(_link_names(survey.links))),
        "rules": dict(survey.finding_counts),
        "unresolved": survey.unresolved,
        "worst": [
            [
                f"{each.kind}, {each.severity}",
                *map(sanitize, (_exchange(each.nodes, each.topics), each.place)),
            ]
            for each in risks
        ],
        "findings": [
            [f"{each.rule}, {each.severity}", sanitize(each.summary), sanitize(each.place)]
            for each in findings
        ],
    }


def _exchange(nodes: tuple[str, ...], topics: tuple[str, ...]) -> str:
    return f"{', '.join(nodes)} on {', '.join(topics)}" if topics else ", ".join(nodes)


def _link_names(links: tuple[FunctionLink, ...]) -> Iterator[str]:
    for link in links:
        if Domain.OTHERS not in (DOMAIN_BY_TYPE[link.source], DOMAIN_BY_TYPE[link.target]):
            yield sections.link_name((link.source, link.target))


def _left_out(survey: Survey) -> str:
    """Return why launch files were left out, and how many for each reason."""
    reasons = Counter(_kind_of_reason(each.reason) for each in survey.left_out)
    rows = [
        row(text(reason), [f'<td class="number">{number}</td>'])
        for reason, number in reasons.most_common(_MOST_REASONS)
    ]
    return table(["Reason", "launch files"], rows) if rows else "<p>None.</p>"


def _kind_of_reason(reason: str) -> str:
    if reason.startswith("needs the argument"):
        return "needs arguments without a default"
    return "is a test" if reason == "is a test" else "cannot be read"

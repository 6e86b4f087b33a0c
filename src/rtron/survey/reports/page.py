"""A survey as one HTML file: the paper's tables beside its own, drawn, and a line for each app.

Like the page of an app it needs no network and allows none. Every figure links to the apps that it
counts, and each app's line opens its worst risks and findings with their places.

As in the paper's figure the stages stand from left to right. An arrow is the broader, the more apps
have the interaction; it leads to those apps.
"""

from collections import Counter
from collections.abc import Iterator, Mapping
from html import escape
from string import Template
from typing import Any
from urllib.parse import quote, urlencode

from lxml import etree

from rtron.errors import InputError
from rtron.functions.domains import DOMAIN_BY_TYPE
from rtron.reports.functions.labels import STAGES
from rtron.reports.functions.svg import lay_out
from rtron.reports.inline_page import inline_json, page_text, policy
from rtron.reports.text_layout import counted
from rtron.sanitize import sanitize
from rtron.survey.app_survey import AppResult, AppSurvey, FunctionLink
from rtron.survey.reports import page_sections as sections
from rtron.survey.reports.page_figures import row, table, text
from rtron.survey.reports.page_sections import link_name, pairs_of_two
from rtron.survey.statistics import RISKS_OF_COMPLEX_APPS, LinkCount, SurveyCounts, counts_by_ros
from rtron.survey.survey_run import Survey
from rtron.vocabulary import Domain, FunctionType, RiskKind

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


_MIN_SHARE = 0.05
"""An interaction with a smaller share of what the most frequent one has is in the matrix only."""
_MOST_ARROWS = 40
_MAX_WIDTH = 7.0
_HEAD = """\
digraph functions {
  graph [rankdir=LR, newrank=true, nodesep=0.25, ranksep=0.9, bgcolor="transparent",
    fontname="Helvetica,Arial,sans-serif", fontsize=14]
  node [fontname="Helvetica,Arial,sans-serif", fontsize=13, shape=ellipse, style=filled,
    fillcolor="#d9d9d9", color="#777777"]
  edge [color="#1d5fe0", arrowsize=0.7, fontname="Helvetica,Arial,sans-serif", fontsize=11]"""
_SVG = "{http://www.w3.org/2000/svg}"


def graph_picture(counts: SurveyCounts) -> str:
    """Return the picture as SVG, or a paragraph that says why there is none."""
    links = _drawn_links(counts)
    if not links:
        return "<p>No functions of an app exchange messages.</p>"
    try:
        root = lay_out("\n".join(_document(counts, links)))
    except InputError as error:
        return f"<p>{escape(str(error))}.</p>"
    for title in root.findall(f".//{_SVG}g[@class='graph']/{_SVG}title"):
        title.text = "The interactions of functions"
    root.set("role", "group")
    root.set("aria-label", "The interactions of functions")
    return etree.tostring(root, encoding="unicode")


def _drawn_links(counts: SurveyCounts) -> list[LinkCount]:
    links = list(pairs_of_two(counts).values())[:_MOST_ARROWS]
    return [link for link in links if link.apps >= _MIN_SHARE * links[0].apps]


def _document(counts: SurveyCounts, links: list[LinkCount]) -> Iterator[str]:
    used = [each for each in FunctionType if any(each in (a.source, a.target) for a in links)]
    ids = {function: f"f{number}" for number, function in enumerate(used)}
    columns = {function: _column(function) for function in used}
    yield _HEAD
    for number, stage in enumerate(STAGES):
        functions = [each for each in used if columns[each] == number]
        if functions:
            yield from _stage(number, stage, functions, ids, counts)
    stages = [f"stage{number}" for number in sorted(set(columns.values()))]
    if len(stages) > 1:
        yield f"  {' -> '.join(stages)} [style=invis]"
    for link in links:
        yield _arrow(link, ids, columns, links[0].apps)
    yield "}"


def _column(function: FunctionType) -> int:
    if function is FunctionType.SENSORS:
        return STAGES.index("Sensors")
    return STAGES.index(str(DOMAIN_BY_TYPE[function]))


def _stage(
    number: int,
    stage: str,
    functions: list[FunctionType],
    ids: Mapping[FunctionType, str],
    counts: SurveyCounts,
) -> Iterator[str]:
    yield f"  subgraph cluster_{number} {{"
    yield f'    label=<<b>{stage}</b>>; style="rounded,filled"; fillcolor="#eef3f7"'
    yield f"    stage{number} [shape=point, style=invis]"
    for function in functions:
        apps = counts.functions.get(function, 0)
        address = urlencode({"function": str(function)}, quote_via=quote)
        label = f'<{function}<br/><font point-size="11">{apps} apps</font>>'
        yield f'    {ids[function]} [label={label}, URL="#{address}", tooltip="{function}"]'
    ranked = "; ".join((f"stage{number}", *(ids[function] for function in functions)))
    yield f"    {{rank=same; {ranked}}}"
    yield "  }"


def _arrow(
    link: LinkCount, ids: Mapping[FunctionType, str], columns: Mapping[FunctionType, int], most: int
) -> str:
    """Return an arrow, the broadest for the `most` apps.

    One that leads back is turned round, so that the stages keep their order.
    """
    leads_back = columns[link.source] > columns[link.target]
    tail, head = (link.target, link.source) if leads_back else (link.source, link.target)
    address = urlencode({"link": link_name((link.source, link.target))}, quote_via=quote)
    types = ", ".join(list(link.types)[:3])
    look = [
        f"penwidth={max(0.8, _MAX_WIDTH * link.apps / most):.2f}",
        f'URL="#{address}"',
        f'tooltip="{link.source} → {link.target}: {link.apps} apps, {types}"',
        f'label="{link.apps}"',
        *(["dir=back"] if leads_back else []),
        *(["constraint=false"] if columns[link.source] == columns[link.target] else []),
    ]
    return f"  {ids[tail]} -> {ids[head]} [{', '.join(look)}]"

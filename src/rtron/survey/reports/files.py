"""A survey as files for programs: JSON lines, one JSON document, CSV."""

import csv
import json
from collections.abc import Iterator, Sequence
from io import StringIO
from typing import Any

from rich.text import Text

from rtron.reports.functions.app_categories import category_rows
from rtron.reports.text_layout import Report, columns, counted, heading, line
from rtron.sanitize import sanitize
from rtron.survey.app_survey import AppResult, AppSurvey
from rtron.survey.statistics import SurveyCounts, counts_by_ros
from rtron.survey.survey_run import Survey
from rtron.vocabulary import RiskKind

SURVEY_SCHEMA = "rtron.survey/1"
_FORMULA_STARTS = ("=", "+", "-", "@")
_COLUMNS = (
    *("app", "repository", "ros", "seconds", "nodes", "topics"),
    *map(str, RiskKind),
    *("grcn", "fps_monitor", "rsrcn", "msrcn"),
    *("findings", "categories", "functions", "unresolved", "error"),
)


def survey_lines(survey: Survey) -> str:
    """Return each app as a line of JSON."""
    return "".join(json.dumps(_app(result)) + "\n" for result in survey.results)


def survey_document(survey: Survey) -> dict[str, Any]:
    """Return all of a survey as one JSON document, with what each app's risks and findings are."""
    return {
        "schema": SURVEY_SCHEMA,
        "seconds": round(survey.seconds, 1),
        "reused": survey.reused,
        "missing": survey.missing,
        "apps": [{**_app(result), **_details(result.survey)} for result in survey.results],
        "left_out": [
            {"location": each.location, "reason": each.reason} for each in survey.left_out
        ],
    }


def survey_csv(survey: Survey) -> str:
    """Return a table with a row for each app (RFC 4180), safe in a spreadsheet."""
    text = StringIO()
    table = csv.DictWriter(text, _COLUMNS)
    table.writeheader()
    for result in survey.results:
        table.writerow({name: _cell(value) for name, value in _row(result).items()})
    return text.getvalue()


def _app(result: AppResult) -> dict[str, Any]:
    head = {
        "app": result.app,
        "repository": result.repository,
        "ros": result.ros,
        "seconds": result.seconds,
    }
    return {**head, **(_numbers(result.survey) if result.survey else {"error": result.error})}


def _numbers(survey: AppSurvey) -> dict[str, Any]:
    required = survey.coordination_nodes
    return {
        "nodes": survey.nodes,
        "topics": survey.topics,
        "risks": {str(kind): survey.risks.get(kind, 0) for kind in RiskKind},
        "coordination_nodes": {
            "grcn": sum(required.grcn.values()),
            "fps_monitor": required.fps_monitor,
            "rsrcn": required.rsrcn,
            "msrcn": required.msrcn,
        },
        "findings": dict(survey.finding_counts),
        "functions": {str(name): len(nodes) for name, nodes in survey.profile.functions.items()},
        "categories": list(survey.profile.categories),
        "unresolved": survey.unresolved,
    }


def _details(survey: AppSurvey | None) -> dict[str, Any]:
    if survey is None:
        return {}
    return {
        "worst_risks": [
            {
                "kind": str(risk.kind),
                "severity": str(risk.severity),
                "topics": list(risk.topics),
                "nodes": list(risk.nodes),
                "place": risk.place,
            }
            for risk in survey.listed_risks
        ],
        "worst_findings": [
            {
                "rule": finding.rule,
                "severity": str(finding.severity),
                "summary": finding.summary,
                "place": finding.place,
            }
            for finding in survey.listed_findings
        ],
        "interactions": [
            {
                "from": str(link.source),
                "to": str(link.target),
                "type": link.type,
                "topics": list(link.topics),
            }
            for link in survey.links
        ],
    }


def _row(result: AppResult) -> dict[str, Any]:
    app = _app(result)
    if result.survey is None:
        return app
    functions = "; ".join(f"{name} {number}" for name, number in app["functions"].items())
    return {
        **{name: app[name] for name in ("app", "repository", "ros", "seconds", "nodes", "topics")},
        **app["risks"],
        **app["coordination_nodes"],
        "findings": sum(app["findings"].values()),
        "categories": "; ".join(app["categories"]),
        "functions": functions,
        "unresolved": app["unresolved"],
    }


def _cell(value: object) -> object:
    if not isinstance(value, str):
        return value
    text = sanitize(value)
    return f"'{text}" if text.startswith(_FORMULA_STARTS) else text


_MOST_LINKS = 10


def survey_text(survey: Survey) -> Report:
    """Return a line for each app, how many have risks of each kind, and of what kind they are."""
    return Report(lambda _: _lines(survey))


def _lines(survey: Survey) -> Iterator[Text]:
    counts = counts_by_ros(survey.results)[0]
    missing = f", {survey.missing} not scanned yet" if survey.missing else ""
    failed = f", {len(counts.failed)} failed" if counts.failed else ""
    yield line((counted(counts.apps, "app"), "bold"), failed, missing)
    yield from columns(
        [_HEADS, *map(_app_row, survey.results)], ("cyan", *("",) * 7, "dim"), indent=2
    )
    yield from heading("Risks")
    yield from columns(list(_risk_rows(counts)), ("", "bold", "", "", ""), indent=2)
    yield from heading("Kinds of apps, beside the paper's")
    rows = category_rows(counts.categories, counts.apps)
    yield from columns(rows, ("", "bold", "dim", "dim"), indent=2)
    if counts.links:
        yield from heading("The most frequent interactions of functions")
        yield from columns(list(_link_rows(counts)), ("", "bold", "dim"), indent=2)


_HEADS = ("app", "ROS", "nodes", "topics", *map(str, RiskKind), "category, or why not scanned")


def _app_row(result: AppResult) -> Sequence[str]:
    survey = result.survey
    if survey is None:
        return result.app, str(result.ros), "-", "-", "-", "-", "-", "-", result.error
    risks = (str(survey.risks.get(kind, 0)) for kind in RiskKind)
    numbers = (str(result.ros), str(survey.nodes), str(survey.topics), *risks)
    return result.app, *numbers, " / ".join(survey.profile.categories) or "none"


def _risk_rows(counts: SurveyCounts) -> Iterator[tuple[str, ...]]:
    yield "kind", "apps with it", "risks", "an app", "in the worst app"
    for risk in counts.risks:
        share = f"{risk.apps} ({risk.apps / counts.apps:.1%})" if counts.apps else "0"
        yield str(risk.kind), share, str(risk.risks), f"{risk.per_app:.2f}", str(risk.most)


def _link_rows(counts: SurveyCounts) -> Iterator[tuple[str, ...]]:
    yield "from and to", "apps", "the most frequent types"
    for link in list(counts.links.values())[:_MOST_LINKS]:
        types = ", ".join(list(link.types)[:3])
        yield f"{link.source} -> {link.target}", str(link.apps), types

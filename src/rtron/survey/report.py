"""What a survey of apps tells: a line of JSON for each, and a table of all."""

import json
from collections.abc import Iterable, Iterator, Sequence

from rich.text import Text

from rtron.functions.app_categories import CategoryCount, count_categories
from rtron.reports.functions.app_categories import category_rows
from rtron.reports.text_layout import Report, columns, counted, heading, line
from rtron.survey.app_scan import AppSurvey
from rtron.vocabulary import RiskKind


def survey_json_line(app: AppSurvey) -> str:
    """Return an app as a line of JSON."""
    required = app.coordination_nodes
    document = {
        "app": app.app,
        "nodes": app.nodes,
        "topics": app.topics,
        "risks": {str(kind): app.risks.get(kind, 0) for kind in RiskKind},
        "coordination_nodes": {
            "grcn": sum(required.grcn.values()),
            "fps_monitor": required.fps_monitor,
            "rsrcn": required.rsrcn,
            "msrcn": required.msrcn,
        },
        "functions": {str(name): len(nodes) for name, nodes in app.profile.functions.items()},
        "categories": list(app.profile.categories),
        "unresolved": app.unresolved,
    }
    return json.dumps(document) + "\n"


def survey_text(apps: Sequence[AppSurvey]) -> Report:
    """Return how many apps have risks of each kind, and of what kind the apps are."""
    return Report(lambda _: _lines(apps, count_categories(app.profile for app in apps)))


def _lines(apps: Sequence[AppSurvey], categories: Sequence[CategoryCount]) -> Iterator[Text]:
    yield line((counted(len(apps), "app"), "bold"))
    yield from heading("Risks")
    yield from columns(list(_risk_rows(apps)), ("", "bold", "", ""), indent=2)
    yield from heading("Kinds of apps, beside the paper's")
    yield from columns(category_rows(categories, len(apps)), ("", "bold", "dim", "dim"), indent=2)


def _risk_rows(apps: Sequence[AppSurvey]) -> Iterator[tuple[str, ...]]:
    yield "kind", "apps with it", "risks", "in the worst app"
    for kind in RiskKind:
        counts = [app.risks.get(kind, 0) for app in apps]
        yield str(kind), _share(counts), str(sum(counts)), str(max(counts, default=0))


def _share(counts: Iterable[int]) -> str:
    has_risk = [number > 0 for number in counts]
    return f"{sum(has_risk)} ({sum(has_risk) / len(has_risk):.1%})" if has_risk else "0"

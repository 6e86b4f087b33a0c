"""What a survey of apps tells: a line of JSON for each, and a table of all."""

import json
from collections.abc import Iterable, Iterator, Sequence

from rich.text import Text

from rtron.functions.apps import CategoryCount, counts
from rtron.reports.functions.app_categories import category_rows
from rtron.reports.text_layout import Report, columns, counted, heading, line
from rtron.survey.surveyed import Surveyed
from rtron.vocabulary import RiskKind


def survey_line(app: Surveyed) -> str:
    """Return an app as a line of JSON."""
    needed = app.coordination_nodes
    document = {
        "app": app.app,
        "nodes": app.nodes,
        "topics": app.topics,
        "risks": {str(kind): app.risks.get(kind, 0) for kind in RiskKind},
        "coordination_nodes": {
            "grcn": sum(needed.grcn.values()),
            "fps_monitor": needed.fps_monitor,
            "rsrcn": needed.rsrcn,
            "msrcn": needed.msrcn,
        },
        "functions": {str(name): len(nodes) for name, nodes in app.row.functions.items()},
        "categories": list(app.row.categories),
        "unresolved": app.unresolved,
    }
    return json.dumps(document) + "\n"


def survey_text(apps: Sequence[Surveyed]) -> Report:
    """Return how many apps have risks of each kind, and of what kind the apps are."""
    return Report(lambda _: _lines(apps, counts(app.row for app in apps)))


def _lines(apps: Sequence[Surveyed], categories: Sequence[CategoryCount]) -> Iterator[Text]:
    yield line((counted(len(apps), "app"), "bold"))
    yield from heading("Risks")
    yield from columns(list(_risks(apps)), ("", "bold", "", ""), indent=2)
    yield from heading("Kinds of apps, beside the paper's")
    yield from columns(category_rows(categories, len(apps)), ("", "bold", "dim", "dim"), indent=2)


def _risks(apps: Sequence[Surveyed]) -> Iterator[tuple[str, ...]]:
    yield "kind", "apps with it", "risks", "in the worst app"
    for kind in RiskKind:
        found = [app.risks.get(kind, 0) for app in apps]
        yield str(kind), _share(found), str(sum(found)), str(max(found, default=0))


def _share(found: Iterable[int]) -> str:
    had = [number > 0 for number in found]
    return f"{sum(had)} ({sum(had) / len(had):.1%})" if had else "0"

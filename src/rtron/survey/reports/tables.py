"""A survey as text: a line for each app, and the counts of all."""

from collections.abc import Iterator, Sequence

from rich.text import Text

from rtron.reports.functions.app_categories import category_rows
from rtron.reports.text_layout import Report, columns, counted, heading, line
from rtron.survey.app_survey import AppResult
from rtron.survey.statistics import SurveyCounts, counts_by_ros
from rtron.survey.survey_run import Survey
from rtron.vocabulary import RiskKind

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

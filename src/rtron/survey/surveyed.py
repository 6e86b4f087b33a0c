"""What a survey tells of an app."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rtron.functions.app_categories import AppProfile, app_profile
from rtron.risks import discover_risks

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtron.survey.app_listing import AppToScan
    from rtron.vocabulary import CoordinationCount, InteractionGraph, RiskKind


@dataclass(frozen=True, slots=True, kw_only=True)
class AppSurvey:
    """An app in numbers: its graph, its risks by kind, the coordination nodes they ask for.

    `unresolved` counts what the scan could not know.
    """

    app: str
    nodes: int
    topics: int
    risks: Mapping[RiskKind, int]
    coordination_nodes: CoordinationCount
    profile: AppProfile
    unresolved: int


def survey_app(app: AppToScan, graph: InteractionGraph) -> AppSurvey:
    """Return what an app's graph tells."""
    report = discover_risks(graph)
    return AppSurvey(
        app=app.name,
        nodes=len(graph.nodes),
        topics=len(graph.topics),
        risks=Counter(risk.kind for risk in report.risks),
        coordination_nodes=report.coordination_nodes,
        profile=app_profile(graph, app.name),
        unresolved=len(graph.unresolved),
    )

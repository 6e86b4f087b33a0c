"""What a survey tells of an app."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rtron.functions.app_categories import AppRow, app_row
from rtron.risks import discover

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtron.survey.app_listing import Subject
    from rtron.vocabulary import CoordinationCount, InteractionGraph, RiskKind


@dataclass(frozen=True, slots=True, kw_only=True)
class Surveyed:
    """An app in numbers: its graph, its risks by kind, the coordination nodes they ask for.

    `unresolved` counts what the scan could not know.
    """

    app: str
    nodes: int
    topics: int
    risks: Mapping[RiskKind, int]
    coordination_nodes: CoordinationCount
    row: AppRow
    unresolved: int


def surveyed(subject: Subject, graph: InteractionGraph) -> Surveyed:
    """Return what an app's graph tells."""
    report = discover(graph)
    return Surveyed(
        app=subject.app,
        nodes=len(graph.nodes),
        topics=len(graph.topics),
        risks=Counter(risk.kind for risk in report.risks),
        coordination_nodes=report.coordination_nodes,
        row=app_row(graph, subject.app),
        unresolved=len(graph.unresolved),
    )

"""The coordination nodes that a graph's risks ask for, beside the paper's (section 7.2)."""

from collections.abc import Iterator, Mapping

from figures.figure import Figure
from rtron.risks import discover_risks
from rtron.vocabulary import Domain, InteractionGraph, Risk, RiskKind, RiskReport, RiskRole

Counts = Mapping[str, int]

COLUMNS = ("Perception", "Planning", "Control", "FMN", "RSRCN", "MSRCN")
_DOMAINS = (Domain.PERCEPTION, Domain.PLANNING, Domain.CONTROL)
_GENERAL = (RiskKind.GR_ST, RiskKind.GR_MT)


def row(report: RiskReport) -> Counts:
    """Return the numbers of a report as the paper's table has them."""
    count = report.coordination_nodes
    numbers = (count.fps_monitor, count.rsrcn, count.msrcn)
    return dict(zip(COLUMNS, (*(count.grcn[d] for d in _DOMAINS), *numbers), strict=True))


def rows(paper: Counts, graphs: Mapping[str, InteractionGraph]) -> Iterator[str]:
    """Yield the table: the paper's row, then one for each graph."""
    yield f"  {'':16}" + "".join(f"{column:>12}" for column in COLUMNS)
    counted = {name: row(discover_risks(graph)) for name, graph in graphs.items()}
    for name, numbers in {"paper": paper, **counted}.items():
        yield f"  {name:16}" + "".join(f"{numbers[column]:12}" for column in COLUMNS)


def topics(graph: InteractionGraph) -> Iterator[str]:
    """Yield a line for each topic that a GRCN would stand on, and for each image node."""
    report = discover_risks(graph)
    found = {t: k for r in report.risks if r.kind in _GENERAL for t, k in _kinds(r)}
    for domain in Domain:
        named = sorted(t for t in found if report.topic_classes[t].domain is domain)
        yield from (f"  {domain.value:11} {topic} ({found[topic]})" for topic in named)
    images = {node for risk in report.risks for node in risk.role_nodes.get(RiskRole.IMAGE, ())}
    yield from (f"  {'FMN':11} {node}" for node in sorted(images))


def differences(ours: InteractionGraph, other: InteractionGraph) -> Iterator[str]:
    """Yield the lines of `topics` that only one of two graphs has."""
    mine, theirs = set(topics(ours)), set(topics(other))
    yield from (f"  only in the scan:{line}" for line in sorted(mine - theirs))
    yield from (f"  only in the truth:{line}" for line in sorted(theirs - mine))


def figures(app: str, paper: Counts, graph: InteractionGraph) -> Iterator[Figure]:
    """Give each number beside the paper's."""
    for column, number in row(discover_risks(graph)).items():
        yield Figure(f"{app}.{column}", number, paper[column], "coordination nodes")


def _kinds(risk: Risk) -> Iterator[tuple[str, str]]:
    yield from ((topic, risk.kind.value) for topic in risk.topics)

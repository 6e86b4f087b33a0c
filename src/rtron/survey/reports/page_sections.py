"""The sections of a survey's page: the paper's figures beside those of the survey."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from statistics import median

from rtron.findings import FINDING_RULES
from rtron.functions.app_categories import PAPER_APP_COUNT
from rtron.functions.domains import DOMAIN_BY_TYPE
from rtron.functions.interactions.abstract_graph import typical_types
from rtron.survey.app_survey import AppSurvey
from rtron.survey.reports.page_figures import (
    apps_link,
    matrix_cell,
    number_cell,
    row,
    share_cell,
    table,
    text,
)
from rtron.survey.statistics import (
    COMPLEX_APPS,
    RSR_APPS,
    RSR_RISKS,
    FunctionPair,
    LinkCount,
    RiskCount,
    SurveyCounts,
)
from rtron.vocabulary import Domain, FunctionType, RiskKind

Counts = Mapping[int, SurveyCounts]
_ROS = (1, 2)
_MOST_LINKS = 20
_MOST_CHANGES = 10
_MOST_TYPES = 3
_COMPLEX_NODES = 20
"""Apps with as many nodes are compared with the paper's complex ones, which have 21 to 38."""
_RULE_TITLES = {rule.name: rule.title for rule in FINDING_RULES}
_GRAPH_FUNCTIONS = [each for each in FunctionType if DOMAIN_BY_TYPE[each] is not Domain.OTHERS]


def category_section(counts: Counts) -> str:
    """Return the paper's table of apps beside the survey's: shares of the apps with a category."""
    whole = {ros: sum(each.apps for each in counts[ros].categories) for ros in _ROS}
    rows = []
    for index, category in enumerate(counts[0].categories):
        cells = [share_cell(category.paper, PAPER_APP_COUNT, "paper")]
        for ros in _ROS:
            number = counts[ros].categories[index].apps
            name = category.categories[0]
            cells.append(share_cell(number, whole[ros], f"ros{ros}", best=name, ros=ros))
        rows.append(row(text(" / ".join(category.categories)), cells))
    heads = [f"ROS {ros}, {whole[ros]} of {counts[ros].apps} apps" for ros in _ROS]
    return table(["Category", f"Paper, {PAPER_APP_COUNT} apps", *heads], rows)


def risk_section(counts: Counts) -> str:
    """Return how many apps have risks of each kind, how many of them, and the app with most."""
    heads = ["Kind", "Paper"]
    heads += chain.from_iterable(
        (f"ROS {ros}, {counts[ros].apps} apps", "risks", "an app (mean)", "most") for ros in _ROS
    )
    rows = []
    for index, kind in enumerate(RiskKind):
        cells = [f"<td>{text(_PAPER_RISKS.get(kind, _PAPER_ALL))}</td>"]
        for ros in _ROS:
            cells += _risk_cells(counts[ros].risks[index], counts[ros].apps, ros)
        rows.append(row(apps_link(kind, risk=kind), cells))
    return table(heads, rows)


_PAPER_ALL = "all of 110 apps found, no number given"
_PAPER_RISKS = {RiskKind.RSR: f"{RSR_RISKS} in {RSR_APPS} apps that were looked at"}


def _risk_cells(risk: RiskCount, apps: int, ros: int) -> Iterator[str]:
    yield share_cell(risk.apps, apps, f"ros{ros}", risk=risk.kind, ros=ros)
    yield number_cell(risk.risks)
    yield number_cell(f"{risk.per_app:.2f}")
    link = apps_link(risk.most, app=risk.worst_app) if risk.most else "0"
    yield f'<td class="number">{link}</td>'


def complex_section(counts: Counts) -> str:
    """Return the coordination nodes of the paper's complex apps beside those of apps as large."""
    heads = ["App", "nodes", "topics", *(f"GRCN {domain}" for domain in _GRCN), "fps monitors"]
    rows = [
        row(
            f"{text(each.name)} <small>paper</small>",
            map(
                number_cell,
                (each.nodes, each.topics, *(each.grcn[d] for d in _GRCN), each.fps_monitor),
            ),
        )
        for each in COMPLEX_APPS
    ]
    return table(heads, [*rows, *filter(None, (_complex_row(counts[ros], ros) for ros in _ROS))])


_GRCN = (Domain.PERCEPTION, Domain.PLANNING, Domain.CONTROL)


def _complex_row(counts: SurveyCounts, ros: int) -> str:
    large = [survey for _, survey in counts.surveys if survey.nodes >= _COMPLEX_NODES]
    if not large:
        return ""
    link = apps_link(f"median of {len(large)} apps", nodes=_COMPLEX_NODES, ros=ros)
    numbers = map(median, zip(*map(_complex_numbers, large), strict=True))
    return row(f"ROS {ros}, {link}", (number_cell(f"{each:g}") for each in numbers))


def _complex_numbers(survey: AppSurvey) -> tuple[int, ...]:
    required = survey.coordination_nodes
    grcn = (required.grcn.get(domain, 0) for domain in _GRCN)
    return survey.nodes, survey.topics, *grcn, required.fps_monitor


def interaction_section(counts: Counts) -> str:
    """Return the pairs of functions that exchange messages in most apps."""
    rows = []
    for pair, link in list(pairs_of_two(counts[0]).items())[:_MOST_LINKS]:
        cells = [
            share_cell(
                _link_apps(counts[ros], pair),
                counts[ros].apps,
                f"ros{ros}",
                link=link_name(pair),
                ros=ros,
            )
            for ros in _ROS
        ]
        types = list(link.types)[:_MOST_TYPES]
        known = typical_types(*pair) & link.types.keys()
        cells.append(f'<td class="types">{text(", ".join(types))}</td>')
        cells.append(f"<td>{'yes' if known else 'no'}</td>")
        rows.append(row(text(f"{pair[0]} → {pair[1]}"), cells))
    heads = [f"ROS {ros}, {counts[ros].apps} apps" for ros in _ROS]
    return table(["Interaction", *heads, "most frequent types", "in the paper's model"], rows)


def matrix_section(counts: Counts) -> str:
    """Return in how many apps each function reaches each other one."""
    links = counts[0].links
    used = [each for each in _GRAPH_FUNCTIONS if any(each in pair for pair in links)]
    largest = max((link.apps for link in links.values()), default=1)
    rows = [
        row(text(source), (_matrix_cell(links.get((source, target)), largest) for target in used))
        for source in used
    ]
    return table(["from, to", *map(str, used)], rows, look="matrix")


def _matrix_cell(link: LinkCount | None, largest: int) -> str:
    if link is None:
        return matrix_cell(0, largest, "")
    types = ", ".join(list(link.types)[:_MOST_TYPES])
    title = f"{link.source} → {link.target}: {types}"
    return matrix_cell(link.apps, largest, title, link=link_name((link.source, link.target)))


def pairs_of_two(counts: SurveyCounts) -> Mapping[FunctionPair, LinkCount]:
    """Return the interactions of two functions, as the paper's graph has them, the most first."""
    return {pair: link for pair, link in counts.links.items() if pair[0] is not pair[1]}


def link_name(pair: FunctionPair) -> str:
    """Return the name of a pair of functions in links and data of the page."""
    return f"{pair[0]}>{pair[1]}"


def _link_apps(counts: SurveyCounts, pair: FunctionPair) -> int:
    return counts.links[pair].apps if pair in counts.links else 0


def generation_section(counts: Counts) -> str:
    """Return what differs between the apps of ROS 1 and those of ROS 2."""
    fields = {
        "nodes": "nodes an app (median)",
        "topics": "topics an app (median)",
        "unresolved": "not known, an app (median)",
    }
    rows = [
        row(text(title), _pair_cells(*(counts[ros].median_of(field) for ros in _ROS)))
        for field, title in fields.items()
    ]
    for index, kind in enumerate(RiskKind):
        of_kind = [counts[ros].risks[index] for ros in _ROS]
        shares = _share_cells(counts, [each.apps for each in of_kind], risk=kind)
        rows.append(row(f"apps with {apps_link(kind, risk=kind)}", shares))
        means = _pair_cells(*(round(each.per_app, 2) for each in of_kind))
        rows.append(row(f"{text(kind)} an app (mean)", means))
    return table(["", "ROS 1", "ROS 2", "change"], rows)


def change_section(counts: Counts) -> str:
    """Return the interactions whose share of apps differs most between ROS 1 and ROS 2."""
    shares = {
        pair: [_link_apps(counts[ros], pair) / (counts[ros].apps or 1) for ros in _ROS]
        for pair in pairs_of_two(counts[0])
    }
    ranked = sorted(shares, key=lambda pair: -abs(shares[pair][1] - shares[pair][0]))
    rows = [
        row(
            text(f"{pair[0]} → {pair[1]}"),
            _share_cells(
                counts, [_link_apps(counts[ros], pair) for ros in _ROS], link=link_name(pair)
            ),
        )
        for pair in ranked[:_MOST_CHANGES]
    ]
    return table(["Interaction", "ROS 1", "ROS 2", "change"], rows)


def _pair_cells(before: float, after: float) -> list[str]:
    return [
        number_cell(f"{before:g}"),
        number_cell(f"{after:g}"),
        number_cell(f"{round(after - before, 2):+g}"),
    ]


def _share_cells(counts: Counts, numbers: Sequence[int], **filters: object) -> list[str]:
    shares = [number / (counts[ros].apps or 1) for ros, number in zip(_ROS, numbers, strict=True)]
    cells = [
        share_cell(number, counts[ros].apps, f"ros{ros}", ros=ros, **filters)
        for ros, number in zip(_ROS, numbers, strict=True)
    ]
    return [*cells, number_cell(f"{100 * (shares[1] - shares[0]):+.1f} points")]


def finding_section(counts: Counts) -> str:
    """Return how many apps have a finding of each rule."""
    rows = [
        row(
            f"{text(_RULE_TITLES.get(rule, rule))} <small>{text(rule)}</small>",
            [
                share_cell(
                    counts[ros].findings.get(rule, 0),
                    counts[ros].apps,
                    f"ros{ros}",
                    rule=rule,
                    ros=ros,
                )
                for ros in _ROS
            ],
        )
        for rule in counts[0].findings
    ]
    heads = [f"ROS {ros}, {counts[ros].apps} apps" for ros in _ROS]
    return table(["Finding", *heads], rows)

"""The abstract interaction graph of a survey's apps, drawn by Graphviz: which functions exchange.

As in the paper's figure the stages stand from left to right. An arrow is the broader, the more apps
have the interaction; it leads to those apps.
"""

from collections.abc import Iterator, Mapping
from html import escape
from urllib.parse import quote, urlencode

from lxml import etree

from rtron.errors import InputError
from rtron.functions.domains import DOMAIN_BY_TYPE
from rtron.reports.functions.labels import STAGES
from rtron.reports.functions.svg import lay_out
from rtron.survey.reports.page_sections import link_name, pairs_of_two
from rtron.survey.statistics import LinkCount, SurveyCounts
from rtron.vocabulary import FunctionType

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

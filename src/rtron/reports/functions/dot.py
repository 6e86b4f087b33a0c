"""The abstract interaction graph in DOT: stages as clusters from left to right.

Functions are grey ellipses, as in the paper's figure; solid arrows are direct interactions with
their message types, strong where these were read in source, pale where they are assumed. Dotted
arrows lead through the environment. An arrow that leads back is written the other way round, and an
invisible point stands in each column, so that the columns keep their order.
"""

from collections.abc import Iterator, Mapping, Sequence
from html import escape

from rtron.functions.interactions.abstract_graph import (
    AbstractGraph,
    Basis,
    DirectInteraction,
    FunctionNode,
)
from rtron.functions.interactions.main_flow import main_flow
from rtron.reports.functions.labels import (
    ENVIRONMENT,
    STAGES,
    best_basis,
    label_lines,
    legend,
    notes,
    stage_of,
)
from rtron.reports.text_layout import counted
from rtron.sanitize import sanitize
from rtron.vocabulary import FunctionType

_FONT = "Helvetica,Arial,sans-serif"
_HEAD = f"""\
digraph functions {{
  graph [rankdir=LR, newrank=true, nodesep=0.2, ranksep=0.4, fontname="{_FONT}", fontsize=14,
    labeljust=l, labelloc=b, style="rounded,filled", color="#c9c9c9"]
  node [fontname="{_FONT}", fontsize=13, style=filled, shape=ellipse, fillcolor="#d9d9d9",
    color="#777777"]
  edge [fontname="{_FONT}", fontsize=11, arrowsize=0.7]"""
_FILLS = dict(zip(STAGES, ("#eef3f7", "#eaf5ea", "#fdf5e2", "#fbeaea", "#eef3f7"), strict=True))
_LOOKS: Mapping[Basis, tuple[str, float]] = {
    Basis.SOURCE: ("#1b1b1b", 2.2),
    Basis.MANIFEST: ("#5f6b76", 1.5),
    Basis.TYPICAL: ("#a3abb3", 1.1),
}
"""The colour and width of arrows, by how the best known of their types is known."""
_FONTS: Mapping[Basis, tuple[str, str]] = {
    Basis.SOURCE: ("#0b2239", "b"),
    Basis.MANIFEST: ("#33475b", ""),
    Basis.TYPICAL: ("#66717c", "i"),
}
"""The colour and the style of types on arrows, by how they are known."""
_CHANGES = ("#7b3fa0", "#0b6e99", "#b35c00")
_COLUMN = {stage: number + (number > 1) for number, stage in enumerate(STAGES)}
_ENVIRONMENT_COLUMN = _COLUMN["Planning"]


def functions_to_dot(graph: AbstractGraph) -> str:
    """Return the graph's main flow as a DOT document."""
    return "\n".join(_lines(main_flow(graph), notes(graph))) + "\n"


def function_ids(graph: AbstractGraph) -> dict[str, str]:
    """Return the id of each function of a graph in DOT."""
    return {node.name: f"f{number}" for number, node in enumerate(graph.functions)}


def label_id(tail: str, head: str) -> str:
    """Return the id of the node that has the types of an arrow inside a column."""
    return f"{tail}_{head}"


def change_ids(graph: AbstractGraph) -> dict[str, str]:
    """Return the id of each thing in the environment that functions change."""
    changes = dict.fromkeys(edge.through for edge in graph.indirect)
    return {change: f"env{number}" for number, change in enumerate(changes)}


def _lines(graph: AbstractGraph, remarks: Sequence[str]) -> Iterator[str]:
    ids, columns = function_ids(graph), _columns(graph)
    yield _HEAD
    yield f"  label={_legend(graph, remarks)}"
    for number, stage in enumerate(STAGES):
        nodes = [node for node in graph.functions if stage_of(node) == stage]
        yield from _stage(number, stage, nodes, ids) if nodes else ()
    yield from _environment(graph, ids, columns)
    yield from _ranks(graph, ids, columns)
    for edge in graph.direct:
        yield from _direct(edge, ids, columns)
    yield "}"


def _columns(graph: AbstractGraph) -> dict[str, int]:
    """Return each function's column: Perception has two, Preprocessing before what works on it."""
    columns = {}
    for node in graph.functions:
        stage = stage_of(node)
        behind = stage == "Perception" and node.function is not FunctionType.PREPROCESSING
        columns[node.name] = _COLUMN[stage] + behind
    return columns


def _ranks(
    graph: AbstractGraph, ids: Mapping[str, str], columns: Mapping[str, int]
) -> Iterator[str]:
    """Yield a rank for each column, in which an invisible point keeps its place."""
    used = sorted({*columns.values(), *([_ENVIRONMENT_COLUMN] if graph.indirect else [])})
    for column in used:
        its = [ids[name] for name, own in columns.items() if own == column]
        its += change_ids(graph).values() if column == _ENVIRONMENT_COLUMN else ()
        yield f"  {{rank=same; {'; '.join((f'column{column} [shape=point, style=invis]', *its))}}}"
    if len(used) > 1:
        yield f"  {' -> '.join(f'column{column}' for column in used)} [style=invis]"


def _stage(
    number: int, stage: str, nodes: Sequence[FunctionNode], ids: Mapping[str, str]
) -> Iterator[str]:
    yield f"  subgraph cluster_{number} {{"
    yield f'    label=<<b>{stage}</b>>; labeljust=c; labelloc=t; fillcolor="{_FILLS[stage]}"'
    for node in nodes:
        packages = counted(node.packages, "package")
        label = f'<{_safe(node.name)}<br/><font point-size="11">{packages}</font>>'
        yield f'    {ids[node.name]} [id="{ids[node.name]}", label={label}]'
    yield "  }"


def _environment(
    graph: AbstractGraph, ids: Mapping[str, str], columns: Mapping[str, int]
) -> Iterator[str]:
    """Yield a box for each thing that changes, who changes it and whom it reaches, each once."""
    changes = change_ids(graph)
    colours = {change: _CHANGES[n % len(_CHANGES)] for n, change in enumerate(changes)}
    if changes:
        yield "  subgraph cluster_environment {"
        yield f'    label=<<b>{ENVIRONMENT}</b>>; labeljust=c; labelloc=t; fillcolor="#f7f3fa"'
        for change, id in changes.items():
            look = f'shape=box, style="rounded,filled", fillcolor=white, color="{colours[change]}"'
            yield f'    {id} [id="{id}", label=<{_safe(change)}>, {look}]'
        yield "  }"
    arrows: dict[tuple[str, str], tuple[str, bool]] = {}
    for edge in graph.indirect:
        change, colour = changes[edge.through], colours[edge.through]
        arrows[ids[edge.source], change] = colour, columns[edge.source] > _ENVIRONMENT_COLUMN
        arrows[change, ids[edge.target]] = colour, columns[edge.target] < _ENVIRONMENT_COLUMN
    for (tail, head), (colour, leads_back) in arrows.items():
        look = f'style=dotted, penwidth=1.6, color="{colour}", weight=0'
        yield _arrow(tail, head, look, leads_back=leads_back)


def _arrow(tail: str, head: str, look: str, *, leads_back: bool) -> str:
    """Return an arrow; one that leads back is turned round, so that the stages keep their order."""
    edge = f"{head} -> {tail}" if leads_back else f"{tail} -> {head}"
    return f'  {edge} [id="{tail}-{head}", {"dir=back, " if leads_back else ""}{look}]'


def _direct(
    edge: DirectInteraction, ids: Mapping[str, str], columns: Mapping[str, int]
) -> Iterator[str]:
    """Yield an arrow with its types; inside a column these stand in a node of their own."""
    tail, head = ids[edge.source], ids[edge.target]
    colour, width = _LOOKS[best_basis(edge)]
    text = "<br/>".join(_styled(line, basis) for line, basis in label_lines(edge))
    look = f'color="{colour}", penwidth={width}'
    if columns[edge.source] != columns[edge.target]:
        leads_back = columns[edge.source] > columns[edge.target]
        yield _arrow(tail, head, f"label=<{text}>, {look}", leads_back=leads_back)
        return
    label, stage = label_id(tail, head), columns[edge.source] - (columns[edge.source] > 1)
    node = f'{label} [id="{label}", label=<{text}>, shape=plain, style="", fontsize=11]'
    yield f"  subgraph cluster_{stage} {{ {node}; {{rank=same; {tail}; {label}; {head}}} }}"
    yield _arrow(tail, label, f"dir=none, {look}", leads_back=False)
    yield _arrow(label, head, look, leads_back=False)


def _styled(text: str, basis: Basis) -> str:
    colour, style = _FONTS[basis]
    words = f"<{style}>{_safe(text)}</{style}>" if style else _safe(text)
    return f'<font color="{colour}">{words}</font>'


def _legend(graph: AbstractGraph, remarks: Sequence[str]) -> str:
    rows = [
        _styled(text, basis) if basis else f'<font color="{_CHANGES[0]}">{text}</font>'
        for basis, text in legend(graph)
    ]
    return "<" + "".join(f'{row}<br align="left"/>' for row in (*rows, *map(_safe, remarks))) + ">"


def _safe(text: str) -> str:
    return escape(sanitize(text))

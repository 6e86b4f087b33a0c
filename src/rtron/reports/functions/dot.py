"""The abstract interaction graph in DOT: domains as clusters from left to right.

Functions are grey ellipses, as in the paper's figure; solid arrows are direct interactions with
their message types, strong where these were read in source, those that are assumed in brackets;
dotted arrows lead through what changes in the environment.
"""

from collections.abc import Iterator, Mapping

from rtron.functions.graph import AbstractGraph, Basis, DirectInteraction, FunctionNode
from rtron.functions.main_flow import main_flow
from rtron.reports.functions.labels import (
    ENVIRONMENT,
    STAGES,
    best_basis,
    label_lines,
    stage_of,
)
from rtron.reports.functions.legend import LOOKS, notes
from rtron.reports.sanitize import neutral
from rtron.reports.text_layout import counted

_HEAD = """\
digraph functions {
  rankdir=LR
  node [fontname="Helvetica", fontsize=11, style=filled, shape=ellipse, fillcolor="gray85"]
  edge [fontname="Helvetica", fontsize=9, arrowsize=0.7]"""
_LEGEND = "(type): assumed, typical of both functions"


def functions_to_dot(graph: AbstractGraph) -> str:
    """Return the graph's main flow as a DOT document."""
    return "\n".join(_lines(main_flow(graph), [_LEGEND, *notes(graph)])) + "\n"


def _lines(graph: AbstractGraph, told: list[str]) -> Iterator[str]:
    ids = {node.name: f"f{number}" for number, node in enumerate(graph.functions)}
    yield _HEAD
    for number, stage in enumerate(STAGES):
        nodes = [node for node in graph.functions if stage_of(node) == stage]
        if nodes:
            yield from _cluster(number, stage, nodes, ids)
    for edge in graph.direct:
        yield f"  {ids[edge.source]} -> {ids[edge.target]} [{_look(edge)}]"
    yield from _environment(graph, ids)
    yield f"  label={_quoted(told)}"
    yield "}"


def _cluster(
    number: int, stage: str, nodes: list[FunctionNode], ids: Mapping[str, str]
) -> Iterator[str]:
    yield f"  subgraph cluster_{number} {{"
    yield f"    label={_quoted([stage])}"
    for node in nodes:
        yield f"    {ids[node.name]} [label={_quoted([node.name, _number(node)])}]"
    yield "  }"


def _environment(graph: AbstractGraph, ids: Mapping[str, str]) -> Iterator[str]:
    """Yield a box for each thing that changes, who changes it and whom it reaches, each once."""
    changes = list(dict.fromkeys(edge.through for edge in graph.indirect))
    boxes = {through: f"env{number}" for number, through in enumerate(changes)}
    for through, box in boxes.items():
        yield f'  {box} [label={_quoted([ENVIRONMENT, through])}, shape=box, fillcolor="white"]'
    acts = [(ids[edge.source], boxes[edge.through]) for edge in graph.indirect]
    reaches = [(boxes[edge.through], ids[edge.target]) for edge in graph.indirect]
    for tail, head in dict.fromkeys(acts + reaches):
        yield f"  {tail} -> {head} [style=dotted, constraint=false]"


def _number(node: FunctionNode) -> str:
    return counted(node.packages, "package")


def _look(edge: DirectInteraction) -> str:
    colour, width = LOOKS[best_basis(edge)]
    lines = [f"({t})" if basis is Basis.TYPICAL else t for t, basis in label_lines(edge)]
    return f'label={_quoted(lines)}, color="{colour}", penwidth={width}'


def _quoted(lines: list[str]) -> str:
    escaped = [neutral(line).replace("\\", "\\\\").replace('"', '\\"') for line in lines]
    return '"' + "\\n".join(escaped) + '"'

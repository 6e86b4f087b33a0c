"""The abstract interaction graph in DOT: domains as clusters from left to right.

Functions are grey ellipses, as in the paper's figure; solid arrows are direct interactions with
their message types, stronger where these were read in source; dotted arrows lead through the
environment.
"""

from collections.abc import Iterator

from rtron.functions.graph import AbstractGraph, DirectInteraction, FunctionNode
from rtron.functions.main_flow import main_flow
from rtron.reports.functions_graph_words import (
    ENVIRONMENT,
    STAGES,
    is_read,
    label_lines,
    stage_of,
)
from rtron.reports.lines import counted
from rtron.reports.neutral import neutral

_HEAD = """\
digraph functions {
  rankdir=LR
  node [fontname="Helvetica", fontsize=11, style=filled, shape=ellipse, fillcolor="gray85"]
  edge [fontname="Helvetica", fontsize=9, color="gray50", arrowsize=0.7]"""


def functions_to_dot(graph: AbstractGraph) -> str:
    """Return the graph's main flow as a DOT document."""
    return "\n".join(_lines(main_flow(graph))) + "\n"


def _lines(graph: AbstractGraph) -> Iterator[str]:
    ids = {node.name: f"f{number}" for number, node in enumerate(graph.functions)}
    yield _HEAD
    for number, stage in enumerate(STAGES):
        nodes = [node for node in graph.functions if stage_of(node) == stage]
        if nodes:
            yield from _cluster(number, stage, nodes, ids)
    if graph.indirect:
        yield f'  env [label="{ENVIRONMENT}", shape=box, fillcolor="white"]'
    for edge in graph.direct:
        yield f"  {ids[edge.source]} -> {ids[edge.target]} [{_look(edge)}]"
    yield from dict.fromkeys(
        end
        for edge in graph.indirect
        for end in (_dotted(ids[edge.source], "env"), _dotted("env", ids[edge.target]))
    )
    yield "}"


def _cluster(
    number: int, stage: str, nodes: list[FunctionNode], ids: dict[str, str]
) -> Iterator[str]:
    yield f"  subgraph cluster_{number} {{"
    yield f"    label={_quoted([stage])}"
    for node in nodes:
        yield f"    {ids[node.name]} [label={_quoted([node.name, _number(node)])}]"
    yield "  }"


def _number(node: FunctionNode) -> str:
    return counted(node.packages, "package")


def _look(edge: DirectInteraction) -> str:
    strong = ', color="black", penwidth=1.6' if is_read(edge) else ""
    return f"label={_quoted(label_lines(edge))}{strong}"


def _dotted(tail: str, head: str) -> str:
    return f"  {tail} -> {head} [style=dotted, constraint=false]"


def _quoted(lines: list[str] | tuple[str, ...]) -> str:
    escaped = [neutral(line).replace("\\", "\\\\").replace('"', '\\"') for line in lines]
    return '"' + "\\n".join(escaped) + '"'

"""The abstract interaction graph as SVG, drawn like the paper's figure; it stands alone."""

from collections.abc import Iterator, Mapping, Sequence
from html import escape

from rtron.functions.graph import AbstractGraph, DirectInteraction, FunctionNode
from rtron.functions.main_flow import main_flow
from rtron.reports.functions_graph_ground import Box
from rtron.reports.functions_graph_layout import Layout, lay_out
from rtron.reports.functions_graph_routes import LINE, Line
from rtron.reports.functions_graph_words import ENVIRONMENT, evidence_words, is_read, stage_of
from rtron.reports.lines import counted
from rtron.reports.neutral import neutral

_TITLE = "The interaction graph of robot functions"
_FONT = "Helvetica, Arial, sans-serif"
_FILLS = {
    "Sensors": "#eef3f7",
    "Perception": "#eaf5ea",
    "Planning": "#fdf5e2",
    "Control": "#fbeaea",
    "Drivers": "#eef3f7",
}
_ARROWS = """\
<defs>
<marker id="solid" viewBox="0 0 8 8" refX="7" refY="4" \
markerUnits="userSpaceOnUse" markerWidth="9" markerHeight="9" \
orient="auto"><path d="M0,0 L8,4 L0,8 z" fill="#555"/></marker>
<marker id="dotted" viewBox="0 0 8 8" refX="7" refY="4" \
markerUnits="userSpaceOnUse" markerWidth="9" markerHeight="9" \
orient="auto"><path d="M0,0 L8,4 L0,8 z" fill="#8a5a9e"/></marker>
</defs>"""
_LEGEND = "solid: direct interaction, strong where read in source; dotted: through the environment"


def functions_to_svg(graph: AbstractGraph) -> str:
    """Return the picture of a graph's main flow as an SVG document."""
    drawn = main_flow(graph)
    return "\n".join(_lines(drawn, lay_out(drawn))) + "\n"


def _lines(graph: AbstractGraph, layout: Layout) -> Iterator[str]:
    edges = {(edge.source, edge.target): edge for edge in graph.direct}
    yield (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {layout.width:.0f} '
        f'{layout.height:.0f}" width="{layout.width:.0f}" height="{layout.height:.0f}" '
        f'font-family="{_FONT}" role="img" aria-label="{_TITLE}">'
    )
    yield f"<title>{_TITLE}</title>"
    yield _ARROWS
    yield f'<rect width="{layout.width:.0f}" height="{layout.height:.0f}" fill="white"/>'
    yield from (_stage(name, box) for name, box in layout.stages.items())
    yield from (_dotted(line) for line in layout.indirect)
    yield from (_solid(line, edges[line.source, line.target]) for line in layout.direct)
    yield from _functions(graph.functions, layout.nodes)
    yield from (_label(line) for line in layout.direct if line.label)
    yield from _environment(layout)
    yield "</svg>"


def _stage(name: str, box: Box) -> str:
    return (
        f"<g>{_rect(box, _FILLS[name], '#c9c9c9')}"
        f'<text x="{box.x + box.width / 2:.0f}" y="{box.y + 19:.0f}" text-anchor="middle" '
        f'font-size="15" font-weight="bold" fill="#444">{name}</text></g>'
    )


def _rect(box: Box, fill: str, stroke: str) -> str:
    return (
        f'<rect x="{box.x:.0f}" y="{box.y:.0f}" width="{box.width:.0f}" '
        f'height="{box.height:.0f}" fill="{fill}" stroke="{stroke}" rx="10"/>'
    )


def _functions(functions: Sequence[FunctionNode], boxes: Mapping[str, Box]) -> Iterator[str]:
    for node in functions:
        box = boxes[node.name]
        x, y = box.x + box.width / 2, box.y + box.height / 2
        yield (
            f'<g class="function" data-name="{_safe(node.name)}" data-stage="{stage_of(node)}">'
            f'<ellipse cx="{x:.0f}" cy="{y:.0f}" rx="{box.width / 2:.0f}" '
            f'ry="{box.height / 2:.0f}" fill="#d9d9d9" stroke="#777"/>'
            f'<text x="{x:.0f}" y="{y:.0f}" text-anchor="middle" font-size="13">'
            f"{_safe(node.name)}</text>"
            f'<text x="{x:.0f}" y="{y + 14:.0f}" text-anchor="middle" font-size="10" '
            f'fill="#555">{counted(node.packages, "package")}</text></g>'
        )


def _solid(line: Line, edge: DirectInteraction) -> str:
    look = 'stroke="#333" stroke-width="1.8"' if is_read(edge) else 'stroke="#777"'
    told = "\n".join(f"{m.type}: {evidence_words(m)}" for m in edge.messages)
    return (
        f'<path class="edge" {_ends(line)} d="{line.path}" fill="none" {look} '
        f'marker-end="url(#solid)"><title>{_safe(f"{edge.source} -> {edge.target}")}\n'
        f"{_safe_lines(told)}</title></path>"
    )


def _dotted(line: Line) -> str:
    return (
        f'<path class="edge" {_ends(line)} d="{line.path}" fill="none" stroke="#8a5a9e" '
        'stroke-width="1.4" stroke-dasharray="1.5 4" stroke-linecap="round" '
        'marker-end="url(#dotted)"/>'
    )


def _label(line: Line) -> str:
    box = line.label
    if box is None:
        return ""
    x = box.x + box.width / 2
    rows = "".join(
        f'<tspan x="{x:.0f}" y="{box.y + LINE * (number + 0.8):.0f}">{_safe(text)}</tspan>'
        for number, text in enumerate(line.lines)
    )
    return (
        f'<text class="label" {_ends(line)} text-anchor="middle" font-size="10.5" fill="#123" '
        f'stroke="white" stroke-width="3" paint-order="stroke">{rows}</text>'
    )


def _ends(line: Line) -> str:
    return f'data-from="{_safe(line.source)}" data-to="{_safe(line.target)}"'


def _environment(layout: Layout) -> Iterator[str]:
    if layout.environment is None:
        return
    box = layout.environment
    y = box.y + box.height / 2
    yield _rect(box, "#f4edf7", "#8a5a9e")
    yield (
        f'<text x="{box.x + box.width / 2:.0f}" y="{y + 5:.0f}" text-anchor="middle" '
        f'font-size="15" font-weight="bold" fill="#5b3a6b">{ENVIRONMENT}</text>'
    )
    yield (
        f'<text x="{box.x + box.width - 12:.0f}" y="{y + 4:.0f}" text-anchor="end" '
        f'font-size="11" fill="#5b3a6b">{_LEGEND}</text>'
    )


def _safe(text: str) -> str:
    return escape(neutral(text))


def _safe_lines(text: str) -> str:
    return "\n".join(map(_safe, text.split("\n")))

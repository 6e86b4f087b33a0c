"""The abstract interaction graph as SVG, drawn like the paper's figure; it stands alone."""

from collections.abc import Iterator, Mapping, Sequence
from html import escape

from rtron.functions.graph import AbstractGraph, Basis, DirectInteraction, FunctionNode
from rtron.functions.main_flow import main_flow
from rtron.reports.functions.environment import EnvironmentLane
from rtron.reports.functions.ground import Box
from rtron.reports.functions.labels import ENVIRONMENT, best_basis, evidence_words, stage_of
from rtron.reports.functions.layout import LEGEND_ROW, Layout, lay_out
from rtron.reports.functions.legend import LOOKS, WORDS, legend_lines, notes
from rtron.reports.functions.routes import LINE, Line
from rtron.reports.sanitize import neutral
from rtron.reports.text_layout import counted

_TITLE = "The interaction graph of robot functions"
_FONT = "Helvetica, Arial, sans-serif"
_FILLS = {
    "Sensors": "#eef3f7",
    "Perception": "#eaf5ea",
    "Planning": "#fdf5e2",
    "Control": "#fbeaea",
    "Drivers": "#eef3f7",
}
_CHANGES = ("#7b3fa0", "#0b6e99", "#b35c00")
_SAMPLE = 44


def functions_to_svg(graph: AbstractGraph) -> str:
    """Return the picture of a graph's main flow as an SVG document."""
    drawn, told = main_flow(graph), notes(graph)
    legend = list(legend_lines(drawn))
    layout = lay_out(drawn, len(legend) + len(told))
    return "\n".join((*_lines(drawn, layout, told), *_legend(layout, legend, told), "</svg>\n"))


def _lines(graph: AbstractGraph, layout: Layout, told: Sequence[str]) -> Iterator[str]:
    edges = {(edge.source, edge.target): edge for edge in graph.direct}
    colours = _colours(layout.lanes)
    yield (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {layout.width:.0f} '
        f'{layout.height:.0f}" width="{layout.width:.0f}" height="{layout.height:.0f}" '
        f'font-family="{_FONT}" role="group" aria-labelledby="graph-title graph-desc">'
    )
    yield f'<title id="graph-title">{_TITLE}</title>'
    yield f'<desc id="graph-desc">{_safe(_description(graph, told))}</desc>'
    yield from _arrowheads(colours)
    yield f'<rect width="{layout.width:.0f}" height="{layout.height:.0f}" fill="white"/>'
    yield from (_stage(name, box) for name, box in layout.stages.items())
    yield from _environment(layout, colours)
    yield from (_dotted(line, colours[line.through]) for line in layout.indirect)
    yield from (_solid(line, edges[line.sources[0], line.targets[0]]) for line in layout.direct)
    yield from _functions(graph.functions, layout.nodes)
    yield from (_label(line, line.label) for line in layout.direct if line.label)


def _description(graph: AbstractGraph, told: Sequence[str]) -> str:
    names = ", ".join(node.name for node in graph.functions) or "none"
    return " ".join((f"Functions: {names}.", *told))


def _colours(lanes: Sequence[EnvironmentLane]) -> Mapping[str, str]:
    return {
        lane.line.through: _CHANGES[number % len(_CHANGES)] for number, lane in enumerate(lanes)
    }


def _arrowheads(colours: Mapping[str, str]) -> Iterator[str]:
    yield "<defs>"
    for basis, (colour, _) in LOOKS.items():
        yield _arrowhead(basis.value, colour)
    for through, colour in colours.items():
        yield _arrowhead(_id(through), colour)
    yield "</defs>"


def _arrowhead(name: str, colour: str) -> str:
    return (
        f'<marker id="{name}" viewBox="0 0 8 8" refX="7" refY="4" markerUnits="userSpaceOnUse" '
        f'markerWidth="10" markerHeight="10" orient="auto">'
        f'<path d="M0,0 L8,4 L0,8 z" fill="{colour}"/></marker>'
    )


def _id(through: str) -> str:
    return "through-" + "".join(letter if letter.isalnum() else "-" for letter in through)


def _stage(name: str, box: Box) -> str:
    return (
        f"<g>{_rect(box, _FILLS[name], '#c9c9c9')}"
        f'<text x="{box.x + box.width / 2:.0f}" y="{box.y + 24:.0f}" text-anchor="middle" '
        f'font-size="18" font-weight="bold" fill="#444">{name}</text></g>'
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
            f'<text x="{x:.0f}" y="{y:.0f}" text-anchor="middle" font-size="15.5">'
            f"{_safe(node.name)}</text>"
            f'<text x="{x:.0f}" y="{y + 17:.0f}" text-anchor="middle" font-size="13" '
            f'fill="#444">{counted(node.packages, "package")}</text></g>'
        )


def _solid(line: Line, edge: DirectInteraction) -> str:
    basis = best_basis(edge)
    told = "\n".join(f"{m.type}: {evidence_words(m)}" for m in edge.messages)
    return (
        f'<path class="edge" {_ends(line)} d="{line.path}" fill="none" {_stroke(basis)} '
        f'marker-end="url(#{basis.value})"><title>{_safe(f"{edge.source} -> {edge.target}")}\n'
        f"{_safe_lines(told)}</title></path>"
    )


def _stroke(basis: Basis) -> str:
    colour, width = LOOKS[basis]
    return f'stroke="{colour}" stroke-width="{width}"'


def _dotted(line: Line, colour: str) -> str:
    head = f' marker-end="url(#{_id(line.through)})"' if line.head else ""
    return f"{_dots(line, colour)}{head}>{_through(line)}</path>"


def _dots(line: Line, colour: str) -> str:
    return (
        f'<path class="edge" {_ends(line)} d="{line.path}" fill="none" stroke="{colour}" '
        'stroke-width="2" stroke-dasharray="0.1 5" stroke-linecap="round"'
    )


def _through(line: Line) -> str:
    ends = f"{', '.join(line.sources)} -> {', '.join(line.targets)}"
    return f"<title>{_safe(f'{line.through}: {ends}')}</title>"


def _label(line: Line, box: Box) -> str:
    """Return a label: a line for each word, or all words side by side where it has one line."""
    x, y = box.x + box.width / 2, box.y + LINE * 0.8
    down = LINE if box.height > LINE else 0
    rows = "  ".join(
        f"<tspan {_at(x, y + down * number) if down else ''}{WORDS[basis]}>{_safe(text)}</tspan>"
        for number, (text, basis) in enumerate(line.words)
    )
    return (
        f'<text class="label" {_ends(line)} {_at(x, y)}text-anchor="middle" font-size="13" '
        f'stroke="white" stroke-width="3.5" paint-order="stroke">{rows}</text>'
    )


def _at(x: float, y: float) -> str:
    return f'x="{x:.0f}" y="{y:.0f}" '


def _ends(line: Line) -> str:
    sources, targets = _safe("|".join(line.sources)), _safe("|".join(line.targets))
    return f'data-from="{sources}" data-to="{targets}"'


def _environment(layout: Layout, colours: Mapping[str, str]) -> Iterator[str]:
    box = layout.environment
    if box is None:
        return
    yield _rect(box, "#f7f3fa", "#8a8a8a")
    for lane in layout.lanes:
        colour = colours[lane.line.through]
        yield f"{_dots(lane.line, colour)}>{_through(lane.line)}</path>"
        yield (
            f'<text class="lane" x="{lane.right + 12:.0f}" y="{lane.y + 5:.0f}" font-size="15" '
            f'font-weight="bold" fill="{colour}">{_safe(lane.line.through)}</text>'
        )
    yield (
        f'<text x="{box.x + box.width / 2:.0f}" y="{box.bottom - 9:.0f}" text-anchor="middle" '
        f'font-size="18" font-weight="bold" fill="#444">{ENVIRONMENT}</text>'
    )


def _legend(
    layout: Layout, legend: Sequence[tuple[Basis | None, str]], told: Sequence[str]
) -> Iterator[str]:
    rows = [*legend, *((None, text) for text in told)]
    for number, (basis, text) in enumerate(rows):
        x, y = layout.legend.x, layout.legend.y + LEGEND_ROW * (number + 0.7)
        sample = number < len(legend)
        if sample:
            yield _sample(basis, x, y - 5)
        look = WORDS[basis] if basis else 'fill="#333"'
        start = x + _SAMPLE + 10 if sample else x
        yield f'<text x="{start:.0f}" y="{y:.0f}" font-size="14" {look}>{_safe(text)}</text>'


def _sample(basis: Basis | None, x: float, y: float) -> str:
    path = f"M{x:.0f},{y:.0f} h{_SAMPLE}"
    if basis is None:
        return (
            f'<path d="{path}" fill="none" stroke="{_CHANGES[0]}" stroke-width="2" '
            'stroke-dasharray="0.1 5" stroke-linecap="round"/>'
        )
    return f'<path d="{path}" fill="none" {_stroke(basis)} marker-end="url(#{basis.value})"/>'


def _safe(text: str) -> str:
    return escape(neutral(text))


def _safe_lines(text: str) -> str:
    return "\n".join(map(_safe, text.split("\n")))

"""The abstract interaction graph as SVG, laid out and drawn by Graphviz; it stands alone."""

import subprocess
from collections.abc import Mapping
from shutil import which

from lxml import etree

from rtron.errors import InputError
from rtron.functions.interactions.abstract_graph import AbstractGraph, DirectInteraction
from rtron.functions.interactions.main_flow import main_flow
from rtron.reports.functions.dot import change_ids, function_ids, functions_to_dot, label_id
from rtron.reports.functions.labels import evidence_text, notes, stage_of
from rtron.sanitize import sanitize

_TITLE = "The interaction graph of robot functions"
_SECONDS = 60
_HALO: Mapping[str | bytes, str | bytes] = {
    "stroke": "white",
    "stroke-width": "3",
    "paint-order": "stroke",
}
_SVG = "{http://www.w3.org/2000/svg}"
_Edges = Mapping[str, tuple[list[str], list[str], str]]


def functions_to_svg(graph: AbstractGraph) -> str:
    """Return the picture of a graph's main flow as an SVG document.

    Raise InputError if Graphviz is not installed.
    """
    drawn = main_flow(graph)
    root = lay_out(functions_to_dot(graph))
    names = ", ".join(node.name for node in drawn.functions) or "none"
    _describe(root, " ".join((f"Functions: {names}.", *notes(graph))))
    _name_functions(root, drawn)
    _name_edges(root, drawn)
    return etree.tostring(root, encoding="unicode") + "\n"


def lay_out(document: str) -> etree._Element:
    """Return the picture of a DOT document as SVG; raise InputError if there is no Graphviz."""
    program = which("dot")
    if program is None:
        raise InputError(
            "the picture needs Graphviz, and there is no `dot`",
            help="sudo apt-get install graphviz, or use --format dot or json",
        )
    command = [program, "-Tsvg"]
    drawn = subprocess.run(  # noqa: S603 - Graphviz, and a document of our own
        command, input=document.encode(), capture_output=True, check=True, timeout=_SECONDS
    ).stdout
    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, remove_comments=True
    )
    return etree.fromstring(drawn, parser)


def _describe(root: etree._Element, text: str) -> None:
    root.set("role", "group")
    root.set("aria-labelledby", "graph-title graph-desc")
    for index, (tag, words) in enumerate((("title", _TITLE), ("desc", text))):
        element = etree.Element(f"{_SVG}{tag}", id=f"graph-{tag}")
        element.text = sanitize(words)
        root.insert(index, element)
    for group in root.iter(f"{_SVG}g"):
        if group.get("class") in ("graph", "cluster"):
            group.remove(group[0])


def _name_functions(root: etree._Element, graph: AbstractGraph) -> None:
    """Say which function each ellipse is."""
    ids = {id: name for name, id in function_ids(graph).items()}
    stages = {node.name: stage_of(node) for node in graph.functions}
    for group in root.iter(f"{_SVG}g"):
        if group.get("class") == "node" and group.get("id") in ids:
            name = ids[group.get("id", "")]
            group.remove(group[0])
            group.set("class", "function")
            group.set("data-name", sanitize(name))
            group.set("data-stage", stages[name])


def _name_edges(root: etree._Element, graph: AbstractGraph) -> None:
    """Say which functions each arrow and each label joins, and what they exchange."""
    edges = {**_direct(graph), **_indirect(graph)}
    for group in root.iter(f"{_SVG}g"):
        if group.get("class") in ("edge", "node"):
            if group.get("class") == "node":
                group.set("class", "label")
            sources, targets, text = edges[group.get("id", "")]
            group.set("data-from", sanitize("|".join(sources)))
            group.set("data-to", sanitize("|".join(targets)))
            group[0].text = text
            for words in group.iter(f"{_SVG}text"):
                words.attrib.update(_HALO)


def _direct(graph: AbstractGraph) -> _Edges:
    ids = function_ids(graph)
    found = {}
    for edge in graph.direct:
        tail, head = ids[edge.source], ids[edge.target]
        label = label_id(tail, head)
        for key in (f"{tail}-{head}", f"{tail}-{label}", label, f"{label}-{head}"):
            found[key] = [edge.source], [edge.target], _title(edge)
    return found


def _title(edge: DirectInteraction) -> str:
    types = [sanitize(f"{m.type}: {evidence_text(m)}") for m in edge.messages]
    return "\n".join((sanitize(f"{edge.source} -> {edge.target}"), *types))


def _indirect(graph: AbstractGraph) -> _Edges:
    """Return the arrows to a change, with all whom it reaches, and from it, with all who act."""
    ids, changes = function_ids(graph), change_ids(graph)
    found: dict[str, tuple[list[str], list[str], str]] = {}
    for edge in graph.indirect:
        change = changes[edge.through]
        for key in (f"{ids[edge.source]}-{change}", change, f"{change}-{ids[edge.target]}"):
            sources, targets, _ = found.get(key, ([], [], ""))
            sources = list(dict.fromkeys((*sources, edge.source)))
            targets = list(dict.fromkeys((*targets, edge.target)))
            text = f"{edge.through}: {', '.join(sources)} -> {', '.join(targets)}"
            found[key] = sources, targets, sanitize(text)
    return found

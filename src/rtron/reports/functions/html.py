"""The abstract interaction graph as one HTML file: the picture, and its interactions as tables.

Like the page of an app it needs no network and allows none.
"""

from collections.abc import Iterator
from html import escape
from string import Template

from rtron.functions.interactions.abstract_graph import AbstractGraph
from rtron.reports.functions.labels import evidence_text, notes
from rtron.reports.functions.svg import functions_to_svg
from rtron.reports.inline_page import page_text, policy
from rtron.reports.text_layout import counted
from rtron.sanitize import sanitize


def functions_to_html(graph: AbstractGraph) -> str:
    """Return the page of a graph."""
    program, style = page_text("functions.js"), page_text("functions.css")
    return Template(page_text("functions.html")).substitute(
        policy=policy((program,), style),
        style=style,
        program=program,
        summary=_summary(graph),
        picture=functions_to_svg(graph),
        notes="\n".join(f"<p>{escape(note)}</p>" for note in notes(graph)),
        direct="\n".join(_direct(graph)),
        indirect="\n".join(_indirect(graph)),
        unresolved="\n".join(_unresolved(graph)),
    )


def _summary(graph: AbstractGraph) -> str:
    inside = graph.packages - graph.outside
    return (
        f"{counted(len(graph.functions), 'function')} of {counted(inside, 'package')}; "
        f"{graph.outside} more have no place in it: tools, extensions, and what nothing tells of."
    )


def _direct(graph: AbstractGraph) -> Iterator[str]:
    for edge in graph.direct:
        for message in edge.messages:
            yield _row(edge.source, edge.target, message.type, evidence_text(message))


def _indirect(graph: AbstractGraph) -> Iterator[str]:
    return (_row(edge.source, edge.target, edge.through) for edge in graph.indirect)


def _unresolved(graph: AbstractGraph) -> Iterator[str]:
    if not graph.unresolved:
        return
    yield "<h2>What could not be read</h2>\n<ul>"
    for note in graph.unresolved:
        locations = ", ".join(f"{each.file}:{each.line}" for each in note.evidence)
        yield f"<li>{escape(sanitize(f'{note.what}: {note.why} ({locations})'))}</li>"
    yield "</ul>"


def _row(source: str, target: str, *more: str) -> str:
    cells = "".join(f"<td>{escape(sanitize(cell))}</td>" for cell in (source, target, *more))
    attributes = f'data-from="{escape(sanitize(source))}" data-to="{escape(sanitize(target))}"'
    return f"<tr {attributes}>{cells}</tr>"

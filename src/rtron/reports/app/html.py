"""The interaction graph as one HTML file: to look at, to search, and to show to others.

The file needs no network, and its Content-Security-Policy allows none: only the scripts and the
style that stand in it, by their hashes. Names that strangers chose come in as JSON and leave as
text nodes; nothing of them is ever read as HTML.
"""

import re
from collections.abc import Sequence
from html import escape
from string import Template

from rtron.reports.app.page_data import NO_LINES, SourceLines, page_data
from rtron.reports.inline_page import inline_json, page_text, policy
from rtron.vocabulary import Finding, InteractionGraph, Plan, RiskReport
from rtron.vocabulary.inventory import Mover

_LAYOUT = ("graph/dagre.LICENSE.txt", "graph/dagre.min.js")
_GRAPH = (
    "graph/isolate.js",
    "graph/model.js",
    "graph/layout.js",
    "graph/draw.js",
    "graph/viewport.js",
)
_SCRIPTS = (*_GRAPH, "filters.js", "panels.js", "main.js")
_MODULE_SYNTAX = re.compile(r"^import .*\n|^export ", re.MULTILINE)


def graph_to_html(
    graph: InteractionGraph,
    report: RiskReport,
    plan: Plan | None,
    findings: Sequence[Finding] = (),
    source_lines: SourceLines = NO_LINES,
    inventory: Sequence[Mover] = (),
) -> str:
    """Return the page of a graph, findings, risks and, with a plan, its coordination nodes.

    `source_lines` are the lines of source at the places of findings, as far as they are known.
    """
    data = page_data(graph, report, plan, findings, source_lines, inventory)
    layout, program, style = "".join(map(page_text, _LAYOUT)), _program(), page_text("page.css")
    return Template(page_text("page.html")).substitute(
        title=escape(data["app"]),
        policy=policy((layout, program), style),
        style=style,
        layout=layout,
        program=program,
        data=inline_json(data),
    )


def _program() -> str:
    """Return the modules as one script, in the order of their imports."""
    modules = (_MODULE_SYNTAX.sub("", page_text(name)) for name in _SCRIPTS)
    return "(() => {\n" + '"use strict";\n' + "".join(modules) + "})();\n"

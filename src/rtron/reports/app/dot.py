"""The interaction graph in DOT, coloured as in the paper's figure of the home app.

Nodes are grey ellipses and topics rectangles. Arrows of GR-ST are blue, of GR-MT red; topics of
MSR events are purple with stripes, of MSR actions purple; RSR image nodes are yellow, RSR max_vel
nodes orange. What the client library adds by itself (`/rosout`, `/clock`) is left out.
"""

from collections.abc import Iterator, Mapping

from rtron.reports.app.risk_list import Edge, RiskMarks, risk_marks
from rtron.sanitize import sanitize
from rtron.vocabulary import Direction, InteractionGraph, RiskReport

_PLAIN_NODE = 'shape=ellipse, fillcolor="gray85"'
_IMAGE = 'shape=ellipse, fillcolor="yellow", penwidth=2'
_MAX_VEL = 'shape=ellipse, fillcolor="orange", penwidth=2'
_PLAIN_TOPIC = 'shape=box, fillcolor="white"'
_EVENT = 'shape=box, style=striped, fillcolor="plum:white:plum:white", penwidth=2'
_ACTION = 'shape=box, fillcolor="plum", penwidth=2'
_SINGLE_TOPIC, _MULTI_TOPIC = "blue", "red"
_HEAD = """\
digraph interaction_graph {
  rankdir=LR
  node [fontname="Helvetica", fontsize=11, style=filled]
  edge [color="gray60", arrowsize=0.7]"""
_LEGEND = {
    "node": _PLAIN_NODE,
    "topic": _PLAIN_TOPIC,
    "GR-ST": f'shape=plaintext, style="", fontcolor="{_SINGLE_TOPIC}"',
    "GR-MT": f'shape=plaintext, style="", fontcolor="{_MULTI_TOPIC}"',
    "MSR event": _EVENT,
    "MSR action": _ACTION,
    "RSR image": _IMAGE,
    "RSR max_vel": _MAX_VEL,
}


def graph_to_dot(graph: InteractionGraph, report: RiskReport) -> str:
    """Return the graph as a DOT document, its risky parts in colour and stronger."""
    return "\n".join(_lines(graph, risk_marks(graph, report))) + "\n"


def _lines(graph: InteractionGraph, colours: RiskMarks) -> Iterator[str]:
    explicit = [endpoint for endpoint in graph.endpoints if not endpoint.implicit]
    nodes = _numbered("n", dict.fromkeys(e.node for e in explicit) | _names(graph))
    topics = _numbered("t", dict.fromkeys(endpoint.topic for endpoint in explicit))
    yield _HEAD
    yield f"  label={_quoted(graph.app)}"
    tooltips = {
        node.name: f", tooltip={_quoted(node.function)}" for node in graph.nodes if node.function
    }
    for name, id in nodes.items():
        yield _vertex(id, name, _node_look(name, colours) + tooltips.get(name, ""))
    yield from (_vertex(id, name, _topic_look(name, colours)) for name, id in topics.items())
    for node, topic, direction in dict.fromkeys((e.node, e.topic, e.direction) for e in explicit):
        pair = (nodes[node], topics[topic])
        tail, head = pair if direction is Direction.PUBLISH else reversed(pair)
        yield f"  {tail} -> {head}{_edge_look((node, topic), colours)}"
    yield from _legend()


def _names(graph: InteractionGraph) -> dict[str, None]:
    return dict.fromkeys(node.name for node in graph.nodes)


def _numbered(letter: str, names: Mapping[str, None]) -> dict[str, str]:
    return {name: f"{letter}{number}" for number, name in enumerate(names)}


def _vertex(id: str, name: str, look: str) -> str:
    return f"  {id} [label={_quoted(name)}, {look}]"


def _node_look(name: str, colours: RiskMarks) -> str:
    if name in colours.image_nodes:
        return _IMAGE
    return _MAX_VEL if name in colours.max_vel_nodes else _PLAIN_NODE


def _topic_look(name: str, colours: RiskMarks) -> str:
    if name in colours.event_topics:
        return _EVENT
    return _ACTION if name in colours.action_topics else _PLAIN_TOPIC


def _edge_look(edge: Edge, colours: RiskMarks) -> str:
    marks = {_SINGLE_TOPIC: colours.single_topic, _MULTI_TOPIC: colours.multi_topic}
    colour = ":".join(name for name, edges in marks.items() if edge in edges)
    return f' [color="{colour}", penwidth=2]' if colour else ""


def _legend() -> Iterator[str]:
    yield "  subgraph cluster_legend {"
    yield '    label="legend"; style=dashed'
    for number, (words, look) in enumerate(_LEGEND.items()):
        yield "  " + _vertex(f"legend{number}", words, look)
    yield "  }"
    yield "}"


def _quoted(text: str) -> str:
    escaped = sanitize(text).replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'

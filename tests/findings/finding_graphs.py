"""Small graphs for the rules of findings, and what they find in them."""

from dataclasses import replace

from notation import graph_of

from rtron.findings import app_facts, find_findings
from rtron.vocabulary import Finding, InteractionGraph, NodeParameter

TWIST, STAMPED = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"

TWO_DRIVERS = f"""
/move_base planner own
    pub /cmd_vel {TWIST}
/teleop teleop own
    pub /cmd_vel {TWIST}
"""
BASE = f"""
/base driver own
    sub /cmd_vel {TWIST}
"""
MUX = f"""
/twist_mux twist_mux third_party
    sub /{{nav,joy}}_vel {TWIST}
    pub /cmd_vel {TWIST}
"""
FIRMWARE = "/firmware serial third_party\n"


def small_graph(text: str, *, ros: int = 2, unread: tuple[str, ...] = (), **changes):
    """Return the graph of a text in the short notation, some of its nodes not read."""
    graph = graph_of("app", text, ros=ros)
    nodes = tuple(replace(node, unread=node.name in unread) for node in graph.nodes)
    return replace(graph, nodes=nodes, **changes)


def with_qos(graph: InteractionGraph, offered, requested) -> InteractionGraph:
    """Return a graph whose publishers offer one QoS and whose subscriptions request another."""
    by_direction = {"publish": offered, "subscribe": requested}
    ends = tuple(replace(end, qos=by_direction[end.direction]) for end in graph.endpoints)
    return replace(graph, endpoints=ends)


def parameters(name: str, **values) -> tuple[NodeParameter, ...]:
    """Return one parameter of several nodes, each with its value."""
    return tuple(
        NodeParameter(node=f"/{node}", name=name, value=value) for node, value in values.items()
    )


def found(rule: str, graph: InteractionGraph) -> list[Finding]:
    """Return what one rule finds in a graph."""
    return [finding for finding in find_findings(app_facts(graph)) if finding.rule == rule]


def the_finding(rule: str, graph: InteractionGraph) -> Finding:
    """Return the only finding of a rule."""
    (finding,) = found(rule, graph)
    return finding

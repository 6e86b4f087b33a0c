"""A node opens the graph to the network.

## What it finds

A bridge lets clients outside of ROS publish and call: rosbridge, Foxglove's bridge, Zenoh's and the
DDS routers, MAVROS' link to ground stations. Such a client needs no account, and can publish motion
commands. Servers that only show topics (web_video_server, rosboard) are oddities.

For example, `/rosbridge_websocket` listens on port 9090 on every address.

## What to do

Bind the bridge to the local address, put it behind a login, or allow only the topics that the
clients need (`topics_glob`, `client_topic_whitelist`). Guard the motion topics.

## When it is silent

For servers that only show topics and listen on the local address.
"""

from collections.abc import Iterator

from rtron.findings.app_facts import AppFacts
from rtron.findings.node_kinds import included_bridges
from rtron.findings.rule import FindingRule, make_finding
from rtron.vocabulary import (
    Certainty,
    Consequence,
    Finding,
    FindingLevel,
    Node,
    UnresolvedItem,
)
from rtron.vocabulary.ros_packages import NETWORK_BRIDGES
from rtron.wording import join_names

_LINKS = {"mavros": ("gcs_url", "a ground station on its link commands the vehicle")}
"""Nodes that forward commands only where a parameter opens a link (wiki.ros.org/mavros)."""
_LINK_TOPIC = "/mavlink_source"
"""What the node with the links publishes in ROS 2, where each plugin is a node of its own."""
_VIEWS = {
    "web_video_server": "whoever reaches its port sees every camera",
    "rosboard": "whoever reaches its port reads every topic",
}
_LOCAL = ("127.", "localhost", "::1")


def check(app: AppFacts) -> Iterator[Finding]:
    """Yield a finding for each bridge of the app."""
    for node in app.graph.nodes:
        if node.package in NETWORK_BRIDGES:
            yield _finding(app, node)
        elif node.package in _VIEWS and not _is_local(app, node.name):
            yield _view(app, node)
    for node in _linked_nodes(app):
        yield from _link(app, node)
    for package, notes in included_bridges(app).items():
        yield _included(app, package, notes)


def _linked_nodes(app: AppFacts) -> list[Node]:
    """Return the nodes that may have a link: of a process with a node for each plugin only one."""
    nodes = [node for node in app.graph.nodes if node.package in _LINKS]
    routers = [
        node
        for node in nodes
        if any(end.topic.endswith(_LINK_TOPIC) for end in app.graph.published_by(node.name))
    ]
    return routers or nodes


def _link(app: AppFacts, node: Node) -> Iterator[Finding]:
    """Yield a finding where the link is open, or where its parameter is not known."""
    name, effect = _LINKS[node.package]
    url = _process_parameter(app, node, name)
    if url == "" or (isinstance(url, str) and any(local in url for local in _LOCAL)):
        return
    is_known = isinstance(url, str)
    yield make_finding(
        RULE.name,
        node.name,
        summary=f"{node.name} opens the app to the network: {effect}",
        cause=f"its {name} is {url}" if is_known else f"its {name} is not known",
        remedy=f"leave {name} empty, or give the link a network of its own",
        consequence=Consequence.MOTION,
        certainty=Certainty.LIKELY if is_known else Certainty.POSSIBLE,
        level=None if is_known else FindingLevel.PEDANTIC,
        nodes=(node.name,),
        evidence=app.evidence(app.graph.published_by(node.name)[:1]),
    )


def _process_parameter(app: AppFacts, node: Node, name: str) -> object:
    """Return the value that a node has of a parameter, or in ROS 2 one beside it in its process."""
    values = {p.node: p.value for p in app.graph.parameters if p.name == name}
    namespace = node.name.rpartition("/")[0]
    beside = [
        values[each.name]
        for each in app.graph.nodes
        if each.name in values
        and app.graph.ros > 1
        and (each.package, each.name.rpartition("/")[0]) == (node.package, namespace)
    ]
    return values.get(node.name, beside[0] if beside else None)


def _view(app: AppFacts, node: Node) -> Finding:
    return make_finding(
        RULE.name,
        node.name,
        summary=f"{node.name} shows the app to the network: {_VIEWS[node.package]}",
        cause=f"{node.package} asks nobody who he is; it publishes nothing",
        remedy="bind it to the local address or put a login before it",
        consequence=Consequence.ODDITY,
        certainty=Certainty.CERTAIN,
        nodes=(node.name,),
        evidence=app.evidence(app.graph.subscribed_by(node.name)),
    )


def _included(app: AppFacts, package: str, notes: list[UnresolvedItem]) -> Finding:
    return make_finding(
        RULE.name,
        package,
        summary=f"{package} {_opens(app, package)}",
        cause="its launch file is included and could not be read; its address is not known",
        remedy="bind it to the local address or put a login before it; allow only needed topics",
        consequence=Consequence.MOTION,
        certainty=Certainty.LIKELY,
        evidence=[place for note in notes for place in note.evidence],
    )


def _opens(app: AppFacts, package: str) -> str:
    """Say what a bridge does, and which commands it reaches."""
    effect = f"{NETWORK_BRIDGES[package]} can publish on every topic"
    reach = f", {join_names(app.motion_topics)} included" if app.motion_topics else ""
    return f"opens the app to the network: {effect}{reach}"


def _finding(app: AppFacts, node: Node) -> Finding:
    address, is_local = _address(app, node.name), _is_local(app, node.name)
    where = f"it listens on {address}" if address else "it listens on every address by default"
    endpoints = app.graph.published_by(node.name) + app.graph.subscribed_by(node.name)
    return make_finding(
        RULE.name,
        node.name,
        summary=f"{node.name} {_opens(app, node.package)}",
        cause=f"{node.package} forwards what its clients send; {where}",
        remedy="bind it to the local address or put a login before it; allow only needed topics",
        consequence=Consequence.MOTION,
        certainty=Certainty.POSSIBLE if is_local else Certainty.CERTAIN,
        level=FindingLevel.PEDANTIC if is_local else None,
        nodes=(node.name,),
        evidence=app.evidence(endpoints),
    )


def _is_local(app: AppFacts, node: str) -> bool:
    return _address(app, node).startswith(_LOCAL)


def _address(app: AppFacts, node: str) -> str:
    values = {p.name: p.value for p in app.graph.parameters if p.node == node}
    address = values.get("address")
    return address if isinstance(address, str) else ""


RULE = FindingRule(
    name="network_bridge",
    title="A node opens the graph to the network",
    consequence="motion: certain; likely where only its include is seen, possible where local",
    since="0.1.0",
    check=check,
)

"""An interaction graph as NoDL, a YAML document for each node.

The Node Definition Language, version 2: github.com/ros-tooling/nodl, package nodl_schema,
`nodl.schema.yaml` and `parameter.schema.yaml`. As `ros2 nodl describe` has it, names are those that
the running app has, a parameter's `default_value` is what it holds at the start, and what client
libraries add is left out. What the schema has no place for stands in comments.
"""

import json
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

import yaml

from rtron.errors import InputError
from rtron.reports.app.node_endpoints import NodeEndpoints, endpoints_by_node
from rtron.vocabulary import Endpoint, InteractionGraph, NodeParameter, QoS

_NAME = re.compile(r"[A-Za-z]|[/~A-Za-z][A-Za-z0-9_/]*[A-Za-z0-9_]", re.ASCII)
_TYPE = re.compile(r"[a-zA-Z]\w*(/(msg|srv|action))?/[A-Z][a-zA-Z0-9]*", re.ASCII)
_ENDING = ".nodl.yaml"
_KINDS: Mapping[type, str] = {bool: "bool", int: "int", float: "double", str: "string"}
_UNKNOWN = {"history": "SYSTEM_DEFAULT", "reliability": "SYSTEM_DEFAULT"}


def graph_to_nodl(graph: InteractionGraph) -> str:
    """Return all nodes as documents of one YAML stream, each after a comment with its name."""
    return "".join(text for _, text in _documents(graph))


def nodl_files(graph: InteractionGraph) -> dict[str, str]:
    """Return a file for each node: `/robot/driver` is `robot__driver.nodl.yaml`."""
    files: dict[str, str] = {}
    for name, text in _documents(graph):
        base = re.sub(r"\W", "_", name.strip("/").replace("/", "__"), flags=re.ASCII)[:200]
        number = next(n for n in range(len(files) + 1) if _numbered(base, n) not in files)
        files[_numbered(base, number)] = text
    return files


def _numbered(base: str, number: int) -> str:
    return f"{base}_{number}{_ENDING}" if number else f"{base}{_ENDING}"


def _documents(graph: InteractionGraph) -> Iterator[tuple[str, str]]:
    if graph.ros == 1:
        raise InputError("the graph is of ROS 1", help="NoDL describes nodes of ROS 2")
    for node in endpoints_by_node(graph):
        yield node.name, _document(node)


def _document(node: NodeEndpoints) -> str:
    left_out: list[str] = []
    document: dict[str, Any] = {"nodl_version": 2}
    if node.description:
        document["description"] = node.description
    sections: dict[str, Any] = {
        "parameters": _parameters(node.parameters, left_out),
        "publishers": _listed("publisher", node.publishers, _topic, left_out),
        "subscriptions": _listed("subscription", node.subscriptions, _topic, left_out),
        "service_servers": _listed("service", node.services, _typed, left_out),
        "service_clients": _listed("client of service", node.clients, _typed, left_out),
        "action_servers": _listed("action server", node.action_servers, _typed, left_out),
        "action_clients": _listed("action client", node.action_clients, _typed, left_out),
    }
    document |= {name: found for name, found in sections.items() if found}
    head = [f"# node {json.dumps(node.name)}", *(f"# not known: {each}" for each in left_out)]
    return "\n".join(["---", *head, yaml.safe_dump(document, sort_keys=False)])


def _listed(
    what: str, endpoints: Iterable[Any], shown: Callable[[Any], dict[str, Any]], left_out: list[str]
) -> list[dict[str, Any]]:
    """Return what the schema takes; a name or a type that is not known it does not."""
    found = {}
    for endpoint in endpoints:
        entry = shown(endpoint)
        if _NAME.fullmatch(entry["name"]) and _TYPE.fullmatch(entry["type"]):
            found[entry["name"], entry["type"]] = entry
        else:
            left_out.append(f"{what} {json.dumps(entry['name'])} {json.dumps(entry['type'])}")
    return list(found.values())


def _typed(endpoint: Any) -> dict[str, Any]:  # noqa: ANN401 - a service, a client or an action
    return {"name": endpoint.name, "type": endpoint.type}


def _topic(endpoint: Endpoint) -> dict[str, Any]:
    return {"name": endpoint.topic, "type": endpoint.type, "qos": _qos(endpoint.qos)}


def _qos(qos: QoS | None) -> dict[str, Any]:
    """Return a profile; what is not known is the system's default, as nodl describes it."""
    if qos is None:
        return dict(_UNKNOWN)
    history = {"history": "KEEP_LAST", "depth": qos.depth} if qos.depth else dict(_UNKNOWN)
    times = {
        "deadline_ns": qos.deadline,
        "lifespan_ns": qos.lifespan,
        "liveliness_lease_duration_ns": qos.lease,
    }
    return {
        **history,
        "reliability": qos.reliability.value.upper(),
        "durability": qos.durability.value.upper(),
        "liveliness": qos.liveliness.value.upper(),
        **{name: value for name, value in times.items() if value},
    }


def _parameters(parameters: Iterable[NodeParameter], left_out: list[str]) -> dict[str, Any]:
    """Return parameters whose value is known, and with it the kind that the schema asks for."""
    found = {}
    for parameter in parameters:
        kind = _kind(parameter.value)
        if kind is None:
            left_out.append(f"kind of parameter {json.dumps(parameter.name)}")
            continue
        value = parameter.value
        default = list(value) if isinstance(value, tuple) else value
        found[parameter.name] = {"type": kind, "default_value": default}
    return found


def _kind(value: object) -> str | None:
    if not isinstance(value, tuple):
        return _KINDS.get(type(value))
    kinds = {_KINDS[type(item)] for item in value}
    return f"{kinds.pop()}_array" if len(kinds) == 1 else None

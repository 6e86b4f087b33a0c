"""The InteractionGraph as JSON, schema `rtron.graph/1`: read from a file, and written."""

from codecs import BOM_UTF8
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, FailFast, Field, TypeAdapter, ValidationError, with_config

from rtron.errors import InputError
from rtron.sources.bounded_file import read_bounded
from rtron.sources.graph_json_errors import graph_file_error
from rtron.vocabulary import (
    Action,
    Endpoint,
    InteractionGraph,
    Node,
    NodeParameter,
    Service,
    ServiceClient,
    Topic,
    UnresolvedItem,
    WiringFact,
)

MAX_BYTES = 512 * 1024 * 1024
_HEAD_BYTES = 4096


@with_config(ConfigDict(extra="forbid", strict=True))
@dataclass(frozen=True, slots=True, kw_only=True)
class GraphDocument:
    """The JSON document of an interaction graph, its keys as they are written."""

    schema: Literal["rtron.graph/1"]
    app: str = ""
    ros: Annotated[int, Field(ge=1, le=2)] = 1
    nodes: Annotated[tuple[Node, ...], FailFast()] = ()
    topics: Annotated[tuple[Topic, ...], FailFast()] = ()
    endpoints: Annotated[tuple[Endpoint, ...], FailFast()] = ()
    services: Annotated[tuple[Service, ...], FailFast()] = ()
    actions: Annotated[tuple[Action, ...], FailFast()] = ()
    clients: Annotated[tuple[ServiceClient, ...], FailFast()] = ()
    parameters: Annotated[tuple[NodeParameter, ...], FailFast()] = ()
    unresolved: Annotated[tuple[UnresolvedItem, ...], FailFast()] = ()
    wiring: Annotated[tuple[WiringFact, ...], FailFast()] = ()


_DOCUMENT = TypeAdapter(GraphDocument)
_OPTIONAL_KEYS = {
    "nodes": ("unread", "process"),
    "endpoints": ("gid",),
    "services": ("implicit",),
    "clients": ("implicit",),
    "parameters": ("read_once",),
    "unresolved": ("missing", "nearest", "package"),
}
_OPTIONAL_LISTS = ("clients", "parameters", "wiring")
"""What not every graph has, and is written only where it is something."""


@dataclass(frozen=True, slots=True)
class GraphFile:
    """A Source that reads a graph from a JSON file; the path `-` is standard input."""

    path: Path

    def read(self) -> InteractionGraph:
        """Return the graph in the file."""
        return read_graph(self.path)


def read_graph(path: Path) -> InteractionGraph:
    """Read a graph from a file (`-` is standard input); raise InputError where it is wrong.

    Nodes and topics that only the endpoints, services or actions name are added.
    """
    return parse_graph(read_bounded(path, MAX_BYTES), str(path))


def parse_graph(data: bytes, path: str) -> InteractionGraph:
    """Read a graph from the bytes of its JSON; `path` is what the errors call it."""
    try:
        return _graph_of_document(_DOCUMENT.validate_json(data.removeprefix(BOM_UTF8)))
    except ValidationError as error:
        if b"\0" in data[:_HEAD_BYTES]:
            help = "give a graph, a bag, a launch file or a folder with source"
            raise InputError("a binary file", path=path, help=help) from None
        raise graph_file_error(error, path) from None


def graph_to_json(graph: InteractionGraph) -> dict[str, Any]:
    """Return the graph as a JSON document; what is not known (`qos`, `gid`) is left out."""
    document = GraphDocument(
        schema="rtron.graph/1",
        app=graph.app,
        ros=graph.ros,
        nodes=graph.nodes,
        topics=graph.topics,
        endpoints=graph.endpoints,
        services=graph.services,
        actions=graph.actions,
        clients=graph.clients,
        parameters=graph.parameters,
        unresolved=graph.unresolved,
        wiring=graph.wiring,
    )
    json: dict[str, Any] = _DOCUMENT.dump_python(document, mode="json", exclude_none=True)
    for key, optional_keys in _OPTIONAL_KEYS.items():
        for each in json[key]:
            for optional in optional_keys:
                if not each[optional]:
                    del each[optional]
    return {key: value for key, value in json.items() if value or key not in _OPTIONAL_LISTS}


def graph_json_schema() -> dict[str, Any]:
    """Return the JSON Schema of the document."""
    return _DOCUMENT.json_schema() | {"title": "rtron.graph/1"}


def _graph_of_document(document: GraphDocument) -> InteractionGraph:
    return InteractionGraph(
        app=document.app,
        ros=document.ros,
        nodes=document.nodes + _implied_nodes(document),
        topics=document.topics + _implied_topics(document),
        endpoints=document.endpoints,
        services=document.services,
        actions=document.actions,
        clients=document.clients,
        parameters=document.parameters,
        unresolved=document.unresolved,
        wiring=document.wiring,
    )


def _implied_nodes(document: GraphDocument) -> tuple[Node, ...]:
    listed = {node.name for node in document.nodes}
    users: tuple[Endpoint | Service | Action | ServiceClient | NodeParameter, ...] = (
        *document.endpoints,
        *document.services,
        *document.actions,
        *document.clients,
        *document.parameters,
    )
    named = dict.fromkeys(user.node for user in users)
    return tuple(Node(name=name) for name in named if name not in listed)


def _implied_topics(document: GraphDocument) -> tuple[Topic, ...]:
    listed = {topic.name for topic in document.topics}
    types: dict[str, dict[str, None]] = {}
    for endpoint in document.endpoints:
        if endpoint.topic not in listed:
            types.setdefault(endpoint.topic, {})[endpoint.type] = None
    return tuple(Topic(name=name, types=tuple(filter(None, t))) for name, t in types.items())

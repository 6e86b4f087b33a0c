"""The InteractionGraph as JSON, schema `rtron.graph/1`: read from a file, and written."""

import re
from codecs import BOM_UTF8
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, FailFast, Field, TypeAdapter, ValidationError, with_config

from rtron.errors import InputError, plain_reason
from rtron.sources.bounded_file import read_bounded
from rtron.vocabulary import (
    GRAPH_SCHEMA,
    Action,
    Endpoint,
    Evidence,
    InteractionGraph,
    Node,
    NodeParameter,
    QoS,
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


_ErrorDetails = Mapping[str, Any]
_MAX_SHOWN = 60
_TOP_LEVEL = ("schema", *(field.name for field in fields(InteractionGraph) if field.init))
_KEYS: Mapping[str, tuple[str, ...]] = {
    key: tuple(field.name for field in fields(noun))
    for key, noun in {
        "nodes": Node,
        "topics": Topic,
        "endpoints": Endpoint,
        "services": Service,
        "actions": Action,
        "unresolved": UnresolvedItem,
        "evidence": Evidence,
        "qos": QoS,
    }.items()
}


def graph_file_error(error: ValidationError, path: str) -> InputError:
    """Return the fault of a graph file that tells most, as an InputError."""
    details = min(error.errors(include_url=False), key=_rank)
    if details["type"] == "json_invalid":
        return _syntax_error(details, path)
    json_path = _json_path(details["loc"])
    return InputError(f"{json_path}: {_message(details)}", path=path, help=_help(details))


def _rank(details: _ErrorDetails) -> int:
    """Put a wrong schema first, then a misspelt key before the key that is missing for it."""
    if details["loc"] == ("schema",):
        return 0
    return 1 if details["type"] == "unexpected_keyword_argument" else 2


def _syntax_error(details: _ErrorDetails, path: str) -> InputError:
    reason = details["ctx"]["error"]
    line = re.search(r"line (\d+)", reason)
    return InputError(
        f"not JSON: {reason}",
        path=path,
        line=int(line[1]) if line else 0,
        help="the graph is one JSON object in UTF-8; was the file cut off?",
    )


def _json_path(location: Sequence[str | int]) -> str:
    """Return a JSON path such as `endpoints[3].direction`."""
    parts = (f"[{part}]" if isinstance(part, int) else f".{part}" for part in location)
    return "".join(parts).removeprefix(".") or "the document"


def _message(details: _ErrorDetails) -> str:
    if details["type"] == "missing":
        return "is missing"
    if details["type"] == "unexpected_keyword_argument":
        return "is not a key of the schema"
    expected = plain_reason(details["msg"]).removeprefix("Input should be ")
    return f"must be {expected}, not {_value_text(details['input'])}"


def _value_text(value: object) -> str:
    if isinstance(value, (dict, list)):
        return "an object" if isinstance(value, dict) else "a list"
    text = repr(value)
    return text if len(text) <= _MAX_SHOWN else text[:_MAX_SHOWN] + "…"


def _help(details: _ErrorDetails) -> str:
    location = details["loc"]
    if location == ("schema",):
        return f'an interaction graph begins {{"schema": "{GRAPH_SCHEMA}", …}}'
    if details["type"] == "unexpected_keyword_argument":
        return _suggestion(str(location[-1]), _keys_at(location[:-1]))
    if "expected" in details.get("ctx", {}):
        choices = re.findall(r"'([^']*)'", details["ctx"]["expected"])
        return _suggestion(str(details["input"]), choices)
    return "correct the value, or leave the key out if it is optional"


def _keys_at(location: Sequence[str | int]) -> Sequence[str]:
    """Return the keys of the object at a place: those of the innermost list or object named."""
    keys = [part for part in location if isinstance(part, str)]
    return _KEYS[keys[-1]] if keys else _TOP_LEVEL


def _suggestion(value: str, choices: Sequence[str]) -> str:
    matches = get_close_matches(value, choices, n=1)
    choices_text = "it can be " + ", ".join(choices)
    return f"did you mean `{matches[0]}`? {choices_text}" if matches else choices_text

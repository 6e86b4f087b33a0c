"""The rights of a bridge's clients, `bridge.yaml`: who may do what, how often and how large.

What is not listed is refused. The pydantic shapes are the file's form and its JSON Schema.
"""

from collections.abc import Collection
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, model_validator

from rtron.vocabulary import BRIDGE_ROOT, PRIVATE_ROOT, normalise_type

RIGHTS_SCHEMA = "rtron.bridge/1"
RIGHTS_SCHEMA_URL = "https://raw.githubusercontent.com/rtron/rtron/main/schemas/rtron.bridge.json"
_LEASES = f"{PRIVATE_ROOT}/leases/"
_ACTIVE, _REQUEST = "/active", "/request"
_NAME = r"(/[A-Za-z][A-Za-z0-9_]*)+"
_WORD = r"[A-Za-z][A-Za-z0-9_]*"

RosName = Annotated[str, Field(pattern=f"^{_NAME}$", max_length=255)]
NamePattern = Annotated[
    str,
    Field(
        pattern=rf"^({_NAME}(:[A-Za-z][A-Za-z0-9_.]*)?|({_NAME})?/\*|{_NAME}:\*)$",
        max_length=255,
        description="a full name, in ROS 2 /node:name; * at the end is all below it",
    ),
]
TypeName = Annotated[str, Field(pattern=f"^{_WORD}/((msg|srv|action)/)?{_WORD}$", max_length=255)]
ClientName = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=60)]
TokenHash = Annotated[
    str, Field(pattern="^sha256:[0-9a-f]{64}$", description="`rtron bridge token NAME` makes one")
]
Rate = Annotated[float, Field(gt=0, le=10_000, description="at most so many a second")]
Size = Annotated[int, Field(ge=64, le=1 << 26, description="bytes")]
WebOrigin = Annotated[str, Field(pattern=r"^https?://[^/\s]+$", max_length=255)]
Approval = Annotated[
    bool, Field(description="a person must approve each message: `rtron bridge approve`")
]
PersonName = Annotated[str, Field(min_length=1, max_length=200)]
HostName = Annotated[str, Field(pattern=r"^[A-Za-z0-9._:-]+$", max_length=255)]


class _Shape(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class PublishRight(_Shape):
    """A topic that a client may publish, at most `rate` messages a second."""

    topic: RosName
    type: TypeName
    rate: Rate = 20.0
    approval: Approval = False


class SubscribeRight(_Shape):
    """A topic that a client may read; of more than `rate` messages a second some are left out."""

    topic: RosName
    type: TypeName
    rate: Rate = 20.0


class CallRight(_Shape):
    """A service that a client may call, at most `rate` times a second."""

    service: RosName
    type: TypeName
    rate: Rate = 1.0
    approval: Approval = False


class ActionRight(_Shape):
    """An action that a client may ask for goals of, at most `rate` a second.

    In ROS 1 these are the five topics of actionlib, and the type is that with `Action` at its end.
    """

    action: RosName
    type: TypeName
    rate: Rate = 1.0
    approval: Approval = False


class ParameterRights(_Shape):
    """The parameters that a client may read and write: `/name` or `/node/*`.

    In ROS 2 they are `/node:name` or `/node:*`.
    """

    read: tuple[NamePattern, ...] = ()
    write: tuple[NamePattern, ...] = ()


class Limits(_Shape):
    """What bounds each client: frames and bytes a second that it sends, sizes, and what waits.

    `queue` messages wait for a slow reader, `calls` services may be unanswered at a time, each for
    at most `call_timeout` seconds.
    """

    frames: Rate = 200.0
    bytes: Annotated[int, Field(ge=1024, le=1 << 30, description="bytes a second")] = 1 << 20
    message: Size = 1 << 20
    queue: Annotated[int, Field(ge=1, le=10_000, description="messages")] = 100
    calls: Annotated[int, Field(ge=1, le=100)] = 4
    call_timeout: Annotated[float, Field(gt=0, le=600, description="seconds")] = 10.0


class ClientRights(_Shape):
    """A client: its node is `/bridge/<name>`, and its tokens are kept as hashes."""

    name: ClientName
    tokens: Annotated[tuple[TokenHash, ...], Field(min_length=1)]
    publish: tuple[PublishRight, ...] = ()
    subscribe: tuple[SubscribeRight, ...] = ()
    call: tuple[CallRight, ...] = ()
    actions: tuple[ActionRight, ...] = ()
    parameters: ParameterRights = ParameterRights()
    limits: Limits = Limits()

    @property
    def node(self) -> str:
        """The name of the client's node."""
        return f"{BRIDGE_ROOT}/{self.name}"

    @model_validator(mode="after")
    def _check_names(self) -> "ClientRights":
        groups = {
            "publish": [each.topic for each in self.publish],
            "subscribe": [each.topic for each in self.subscribe],
            "call": [each.service for each in self.call],
            "actions": [each.action for each in self.actions],
        }
        for group, names in groups.items():
            for name in names:
                _check_name(group, name, names)
        return self


class Approvers(_Shape):
    """Who at the security service may approve what needs a person: by role or by name, or nobody.

    Persons beside the robot may at any rate, with `rtron bridge approve`.
    """

    roles: tuple[Literal["developer", "end_user"], ...] = ()
    names: tuple[PersonName, ...] = ()

    def include(self, name: str, roles: Collection[str]) -> bool:
        """Tell whether a person of the service is one of them."""
        return name in self.names or not set(self.roles).isdisjoint(roles)


class BridgeRights(_Shape):
    """The file: its clients, the web pages that may connect, and how many clients at a time.

    `origins` are the pages' addresses. `hosts` are the names by which clients call this machine,
    beside its own addresses. `approvers` are persons at the security service.
    """

    schema_: Literal["rtron.bridge/1"] = Field(alias="schema")
    clients: tuple[ClientRights, ...]
    approvers: Approvers = Approvers()
    origins: tuple[WebOrigin, ...] = ()
    hosts: tuple[HostName, ...] = ()
    max_clients: Annotated[int, Field(ge=1, le=1000)] = 32

    @model_validator(mode="after")
    def _check_clients(self) -> "BridgeRights":
        names = [each.name for each in self.clients]
        hashes = [token for each in self.clients for token in each.tokens]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"there are two clients {name}")
        if len(set(hashes)) < len(hashes):
            raise ValueError("two tokens are one: each client needs its own")
        return self


def _check_name(group: str, name: str, names: list[str]) -> None:
    if names.count(name) > 1:
        raise ValueError(f"{group} has {name} twice")
    if name == PRIVATE_ROOT or (name.startswith(f"{PRIVATE_ROOT}/") and not _is_open(group, name)):
        raise ValueError(f"{name} is the guard's own")


def _is_open(group: str, name: str) -> bool:
    """Tell whether a name of the guard is for others: leases, and which flow has control."""
    if group == "subscribe":
        return name.startswith(_LEASES) or name.endswith(_ACTIVE)
    return group == "publish" and name.startswith(_LEASES) and name.endswith(_REQUEST)


def same_type(one: str, other: str) -> bool:
    """Tell whether two spellings are one type."""
    short = [
        normalise_type(each).replace("/srv/", "/").replace("/action/", "/") for each in (one, other)
    ]
    return short[0] == short[1]


def matches_name(pattern: str, name: str) -> bool:
    """Tell whether a name is that of a pattern, or below it if it ends with `/*` or `:*`."""
    if pattern.endswith("*"):
        return name.startswith(pattern[:-1])
    return pattern == name


RIGHTS = TypeAdapter(BridgeRights)


def rights_json_schema() -> dict[str, Any]:
    """Return the JSON Schema of `bridge.yaml`, for editors."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": RIGHTS_SCHEMA_URL,
        **RIGHTS.json_schema(by_alias=True),
        "title": RIGHTS_SCHEMA,
    }

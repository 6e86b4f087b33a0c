"""How a model is written: what it stands for, where it was read, and what it declares.

docs/models.md explains every key with an example.
"""

import re
from collections.abc import Iterator
from typing import Annotated

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from rtron.sources.declaration import DeclarationKind
from rtron.vocabulary import Durability, QoS, Reliability, StringEnum

ENTRY_VERBS = (
    *(kind.value for kind in DeclarationKind),
    *("uses", "unresolved", "declares", "broadcast", "look_up", "stamp"),
    *("offer", "request"),
)
MODEL_KINDS = (
    "node",
    "nodelet",
    "component",
    "gazebo_plugin",
    "controller",
    "hardware",
    "costmap_layer",
    "plugin",
    "part",
)
ANY_TYPE = "any"
_SOURCE = re.compile(r"github\.com/[\w.-]+/[\w.-]+@[\w./-]+( [\w./-]+)?")
_LOCATION = re.compile(r"[\w./+-]+(:[0-9]+)?")


class NodeRole(StringEnum):
    """What a node type does that shows at other nodes."""

    NODELET = "nodelet"
    GAZEBO = "gazebo"
    MODEL_SPAWNER = "model_spawner"
    CONTROLLER_SPAWNER = "controller_spawner"
    CONTROLLER_MANAGER = "controller_manager"
    FIRMWARE = "firmware"


def _as_list(value: object) -> object:
    return [value] if isinstance(value, str) else value


Names = Annotated[tuple[str, ...], BeforeValidator(_as_list)]
Text = Annotated[str, Field(max_length=1000)]


class ModelEntry(BaseModel):
    """One entry of `declares`: a verb with its name, and when, how often and where it holds."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    publish: Text | None = None
    subscribe: Text | None = None
    service: Text | None = None
    service_client: Text | None = None
    action_client: Text | None = None
    action_server: Text | None = None
    uses: Text | None = None
    unresolved: Text | None = None
    declares: tuple["ModelEntry", ...] | None = None
    broadcast: Text | None = None
    look_up: Text | None = None
    stamp: Text | None = None
    offer: Text | None = None
    request: Text | None = None
    parent: Text = ""
    fixed: bool = False
    type: Text = ""
    implicit: bool = False
    latched: bool = False
    qos: Annotated[Text, BeforeValidator(str)] = ""
    condition: Text | None = Field(default=None, alias="if")
    loop: Annotated[Text, Field(pattern=r"^[a-z_]+ in .+")] | None = Field(
        default=None, alias="for"
    )
    let: dict[str, Text] = {}
    passed: dict[str, Text] = Field(default={}, alias="with")
    namespace: Text | None = None
    private: Text | None = None
    node: Text | None = None
    why: Text = ""
    line: int = Field(default=0, ge=0)
    at: str = ""

    @model_validator(mode="after")
    def _consistent(self) -> "ModelEntry":
        verbs = [verb for verb in ENTRY_VERBS if getattr(self, verb) is not None]
        if len(verbs) != 1:
            raise ValueError(f"an entry needs exactly one of {', '.join(ENTRY_VERBS)}")
        if self.kind is not None and not self.type:
            raise ValueError(f"{verbs[0]} needs a type")
        if self.at and not _LOCATION.fullmatch(self.at):
            raise ValueError("at is written path:line")
        return self

    @property
    def kind(self) -> DeclarationKind | None:
        """The kind of declaration, None for an entry that only leads to others."""
        return next((kind for kind in DeclarationKind if getattr(self, kind.value)), None)

    @property
    def name(self) -> str:
        """The declared name as it is written, empty for an entry that only leads to others."""
        return str(getattr(self, self.kind.value)) if self.kind else ""


class Model(BaseModel):
    """What one node type, plugin or part declares; `source` is the public file it was read in.

    `over_source` says that the model counts even where the node's source is there, since plugins
    or files decide at run time what it declares. `role` is what the node does to others. `name` is
    what a node of ROS 2 calls itself where its launch gives it no name, `former` what it called
    itself in older releases; one without `parameter_services` cannot be asked for its parameters.
    `unread` says that more than the model decides what the node publishes and subscribes, such as
    firmware.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    node: Names = ()
    nodelet: Names = ()
    component: Names = ()
    gazebo_plugin: Names = ()
    controller: Names = ()
    hardware: Names = ()
    costmap_layer: Names = ()
    plugin: Names = ()
    part: Names = ()
    source: str
    name: str = ""
    former: Names = ()
    implicit: bool = False
    over_source: bool = False
    parameter_services: bool = True
    unread: bool = False
    role: NodeRole | None = None
    needs: Names = ()
    let: dict[str, Text] = {}
    declares: tuple[ModelEntry, ...] = ()

    @model_validator(mode="after")
    def _consistent(self) -> "Model":
        if not any(getattr(self, kind) for kind in MODEL_KINDS):
            raise ValueError(f"a model needs one of {', '.join(MODEL_KINDS)}")
        if not _SOURCE.fullmatch(self.source):
            raise ValueError("source is written github.com/OWNER/NAME@TAG PATH")
        return self

    @property
    def is_python(self) -> bool:
        """Whether the node is of rclpy, or rospy: its source is Python."""
        return self.source.endswith(".py")

    def walk(self) -> Iterator[ModelEntry]:
        """Yield every entry, groups before what stands in them."""
        pending = list(self.declares)
        while pending:
            entry = pending.pop(0)
            yield entry
            pending[:0] = entry.declares or ()


def parse_qos(text: str) -> QoS | None:
    """Return what words say, None for none; raise ValueError for what is no policy."""
    if not text:
        return None
    depth, reliability, durability = 0, Reliability.RELIABLE, Durability.VOLATILE
    for token in text.split():
        if token.isdecimal():
            depth = int(token)
        elif token in set(Reliability):
            reliability = Reliability(token)
        elif token in set(Durability):
            durability = Durability(token)
        else:
            raise ValueError(f"{token[:80]!r} is no quality of service")
    return QoS(depth=depth, reliability=reliability, durability=durability)

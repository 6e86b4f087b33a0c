"""What the parts of a client's session share: its rights, the effects so far, and its status."""

from dataclasses import dataclass, field
from typing import Protocol

from rtron.bridge.common.plan_topics import PlanTopics
from rtron.bridge.protocol.approvals import Approvals
from rtron.bridge.protocol.effects import Effect, SendAnswer
from rtron.bridge.protocol.frames import Document, encode_frame
from rtron.bridge.protocol.rate_limit import ClientRates, RefusalCounter
from rtron.bridge.rights.document import ClientRights
from rtron.messages import Definition, Encoding
from rtron.messages.common.json_encoder import encode_json

_MAX_REASON = 500
_MAX_NAMED = 5


class StatusLevel:
    """How much a client is told, from nothing to every success (rosbridge v2.0, 3.2)."""

    ORDER = ("none", "error", "warning", "info")


@dataclass(frozen=True, slots=True)
class ActionDefinitions:
    """The parts of an action's type; a result is in the field `result`, beside its `status`."""

    goal: Definition
    result: Definition
    feedback: Definition


class KnownTypes(Protocol):
    """The message and service types that are known here; InputError or SourceError if not."""

    encoding: Encoding

    def message(self, type: str) -> Definition:
        """Return the definition of a message type."""

    def service(self, type: str) -> tuple[Definition, Definition]:
        """Return the definitions of a service's request and response."""

    def action(self, type: str) -> ActionDefinitions:
        """Return the definitions of an action's parts."""


@dataclass(slots=True)
class ClientState:
    """One client, from its sign-in on. Times are ns, `wall_time` those since 1970."""

    client: ClientRights
    topics: PlanTopics
    types: KnownTypes
    ros: int
    rates: ClientRates
    approvals: Approvals
    level: str = "error"
    effects: list[Effect] = field(default_factory=list)
    refusals: RefusalCounter = field(default_factory=RefusalCounter)
    refused: int = 0
    """How many operations were refused so far."""

    def send(self, document: Document) -> None:
        """Send a frame that is not dropped."""
        self.effects.append(SendAnswer(encode_frame(document)))

    def tell(self, level: str, reason: str, id: object = None) -> None:
        """Send a status message, if the client wants to hear of this level."""
        if StatusLevel.ORDER.index(level) > StatusLevel.ORDER.index(self.level):
            return
        document: Document = {"op": "status", "level": level, "msg": reason[:_MAX_REASON]}
        if id is not None:
            document["id"] = id
        self.send(document)

    def refuse(self, reason: str, now: int, id: object = None) -> None:
        """Tell the client why an operation is refused; the same reason once a second."""
        self.refused += 1
        hushed = self.refusals.count(reason, now)
        if hushed is not None:
            more = f" ({hushed} times more meanwhile)" if hushed else ""
            self.tell("error", f"{reason[: _MAX_REASON - 40]}{more}", id)

    def check_approval(self, what: str, content: object, now: int) -> None:
        """Use up the approval of a person; WireError if it is not there yet."""
        self.approvals.check(self.client.name, what, content, now)

    def encode(self, definition: Definition, value: object, wall_time: int, id: object) -> bytes:
        """Return a message's bytes, and warn of missing fields; WireError if it does not fit."""
        limit = self.client.limits.message
        message, missing = encode_json(definition, self.types.encoding, value, wall_time, limit)
        if missing:
            names = ", ".join(missing[:_MAX_NAMED])
            self.tell("warning", f"{definition.type}: left out, so zero or empty: {names}", id)
        return message

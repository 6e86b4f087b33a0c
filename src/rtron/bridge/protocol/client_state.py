"""What the parts of a client's session share: its rights, the effects so far, and its status."""

from dataclasses import dataclass, field
from typing import Protocol

from rtron.bridge.common.plan_topics import PlanTopics
from rtron.bridge.protocol.approvals import Approvals
from rtron.bridge.protocol.effects import Effect, SendAnswer
from rtron.bridge.protocol.frames import Document, encode_frame
from rtron.bridge.rights.document import ClientRights
from rtron.messages import Definition, Encoding
from rtron.messages.common.json_encoder import encode_json
from rtron.vocabulary import SECOND


@dataclass(slots=True)
class TokenBucket:
    """Lets `rate` a second pass, and up to `burst` at once (the leaky bucket as a meter, I.371)."""

    rate: float
    burst: float
    _level: float = 0.0
    _updated: int = 0

    def take(self, now: int, count: float = 1.0) -> bool:
        """Take `count` at a time (ns); False, and nothing is taken, if so many do not fit."""
        elapsed = max(0, now - self._updated)
        level = max(0.0, self._level - elapsed * self.rate / SECOND)
        self._level, self._updated = level, max(now, self._updated)
        if level + count > self.burst:
            return False
        self._level = level + count
        return True


def message_bucket(rate: float) -> TokenBucket:
    """Return a bucket for messages of a rate: those of a fifth of a second may come together."""
    return TokenBucket(rate, max(1.0, rate / 5))


class ClientRates:
    """The buckets of one client, which outlast its connections: who comes again has the same."""

    def __init__(self) -> None:
        self._buckets: dict[str, TokenBucket] = {}

    def keep(self, what: str, bucket: TokenBucket) -> TokenBucket:
        """Return the bucket of what the client does: `bucket`, if there was none yet."""
        return self._buckets.setdefault(what, bucket)


class RefusalCounter:
    """How often a client was refused lately: each reason once a second, the others counted."""

    def __init__(self, period: int = SECOND, max_reasons: int = 32) -> None:
        self._period = period
        self._max_reasons = max_reasons
        self._reported: dict[str, tuple[int, int]] = {}

    def count(self, reason: str, now: int) -> int | None:
        """Count a refusal; return how often it was hushed before, None if it is not to be said."""
        since, hushed = self._reported.get(reason, (now - self._period, 0))
        if now - since < self._period:
            self._reported[reason] = since, hushed + 1
            return None
        self._forget(now)
        if len(self._reported) >= self._max_reasons:
            return None
        self._reported[reason] = now, 0
        return hushed

    def _forget(self, now: int) -> None:
        self._reported = {
            reason: (since, hushed)
            for reason, (since, hushed) in self._reported.items()
            if now - since < self._period
        }


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

"""What rosapi tells of an app, answered from a client's rights: what it may use, and nothing else.

The answers are those of the services of the package rosapi (rosapi/srv, rosapi/msg/TypeDef).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtron.bridge.common.plan_topics import topic_rights
from rtron.bridge.rights.document import same_type
from rtron.errors import WireError
from rtron.messages.common.json_encoder import TIME_FIELDS
from rtron.vocabulary import SECOND

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtron.bridge.protocol.client_state import ClientState
    from rtron.bridge.protocol.frames import Document
    from rtron.messages import Definition
    from rtron.messages.common.definition import Field

ROSAPI = "/rosapi/"
_SINGLE, _OF_ANY_LENGTH = -1, 0
"""What rosapi says instead of the length of an array."""


class RosApi:
    """Answers questions about the app of one client."""

    def __init__(self, state: ClientState) -> None:
        self._state = state
        self._answers: dict[str, Callable[[Document, int], Document]] = {
            "topics": lambda args, now: self._topics(),
            "topic_type": lambda args, now: {
                "type": self._known_topics().get(_text(args, "topic"), "")
            },
            "topics_for_type": lambda args, now: {"topics": self._topics_of(_text(args, "type"))},
            "services": lambda args, now: {"services": list(self._known_services())},
            "service_type": lambda args, now: {
                "type": self._known_services().get(_text(args, "service"), "")
            },
            "action_servers": lambda args, now: {
                "action_servers": [right.action for right in state.client.actions]
            },
            "message_details": lambda args, now: self._message_details(_text(args, "type")),
            "service_request_details": lambda args, now: self._service_details(args, 0),
            "service_response_details": lambda args, now: self._service_details(args, 1),
            "get_time": lambda args, now: self._time(now),
        }

    def knows(self, name: str) -> bool:
        """Tell whether a service of rosapi is answered here."""
        return name in self._answers

    def answer(self, name: str, args: Document, wall_time: int) -> Document:
        """Return the answer of a service; WireError if it tells what the client may not know."""
        return self._answers[name](args, wall_time)

    def _known_topics(self) -> dict[str, str]:
        client, ros = self._state.client, self._state.ros
        return {right.topic: right.type for right in topic_rights(client, ros)}

    def _known_services(self) -> dict[str, str]:
        return {right.service: right.type for right in self._state.client.call}

    def _topics(self) -> Document:
        known = self._known_topics()
        return {"topics": list(known), "types": list(known.values())}

    def _topics_of(self, type: str) -> list[str]:
        return [topic for topic, own in self._known_topics().items() if same_type(own, type)]

    def _message_details(self, type: str) -> Document:
        if not self._topics_of(type):
            raise WireError(f"{self._state.client.name} has no topic of type {type[:80]}")
        return {"typedefs": list(_type_definitions(self._state.types.message(type)).values())}

    def _service_details(self, args: Document, part: int) -> Document:
        type = _text(args, "type")
        if not any(same_type(own, type) for own in self._known_services().values()):
            raise WireError(f"{self._state.client.name} calls no service of type {type[:80]}")
        definition = self._state.types.service(type)[part]
        return {"typedefs": list(_type_definitions(definition).values())}

    def _time(self, wall_time: int) -> Document:
        names = TIME_FIELDS[self._state.types.encoding]
        return {"time": dict(zip(names, divmod(wall_time, SECOND), strict=True))}


def _text(args: Document, name: str) -> str:
    found = args.get(name)
    return found if isinstance(found, str) else ""


def _type_definitions(definition: Definition) -> dict[str, Document]:
    """Return a type and all types in it, each once, as rosapi describes them."""
    found: dict[str, Document] = {}
    pending = [definition]
    while pending:
        each = pending.pop(0)
        if each.type not in found:
            found[each.type] = {
                "type": each.type,
                "fieldnames": [field.name for field in each.fields],
                "fieldtypes": [field.type for field in each.fields],
                "fieldarraylen": [_array_length(field) for field in each.fields],
                "examples": ["" for _ in each.fields],
                "constnames": [],
                "constvalues": [],
            }
            pending += each.nested.values()
    return found


def _array_length(field: Field) -> int:
    if not field.array:
        return _SINGLE
    return _OF_ANY_LENGTH if field.length is None else field.length

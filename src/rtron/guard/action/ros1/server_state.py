"""What an action's server says: whether it is there, which goals it has, what results look like."""

from dataclasses import dataclass, field

from rtron.errors import InputError
from rtron.guard.transport.common.protocol import TypeInfo
from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.common.encoding import Encoding
from rtron.messages.common.layout import zero_body_size
from rtron.messages.ros1.actions import after_header, read_statuses

# A header without a frame, and a status without id and text: what every result begins with.
_HEAD = 16 + 17


@dataclass(slots=True)
class ServerState:
    """The server as far as it is known.

    `told` is its last status array, of time `last_status_time` (ns), `listed_goals` the state of each goal in it.
    """

    node: str = ""
    last_status: bytes = b""
    last_status_time: int = 0
    listed_goals: dict[bytes, int] = field(default_factory=dict)
    empty_result: bytes | None = None
    _last_body: bytes = b""

    def update(self, status_array: bytes, now: int) -> None:
        """Take a status array; most say what the one before has said."""
        body = after_header(status_array)
        if body != self._last_body:
            self.listed_goals = read_statuses(status_array)
        self.last_status, self.last_status_time, self._last_body = status_array, now, body

    def clear(self) -> None:
        """Learn that the server is gone."""
        self.node, self.last_status, self.listed_goals, self._last_body = "", b"", {}, b""

    def learn_result(self, info: TypeInfo) -> None:
        """Know how a result looks in which everything is 0 or empty; InputError if it cannot."""
        definition = parse_definition(info.type, info.definition)
        size = zero_body_size(definition, Encoding.ROS1)
        if size is None or size < _HEAD or definition.md5sum != info.md5sum:
            raise InputError(f"{info.type} is no action's result")
        self.empty_result = bytes(size - _HEAD)

"""What an action's server says: whether it is there, which goals it has, what results look like."""

from dataclasses import dataclass, field

from rtron.errors import InputError
from rtron.guard.transport.common.protocol import TypeInfo
from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.common.encoding import Encoding
from rtron.messages.common.layout import zeros_size
from rtron.messages.ros1.actions import behind_header, read_statuses

# A header without a frame, and a status without id and text: what every result begins with.
_HEAD = 16 + 17


@dataclass(slots=True)
class Server:
    """The server as far as it is known.

    `told` is its last status array, of time `at` (ns), `listed` the state of each goal in it.
    """

    node: str = ""
    told: bytes = b""
    at: int = 0
    listed: dict[bytes, int] = field(default_factory=dict)
    empty_result: bytes | None = None
    _body: bytes = b""

    def says(self, told: bytes, now: int) -> None:
        """Take a status array; most say what the one before has said."""
        body = behind_header(told)
        if body != self._body:
            self.listed = read_statuses(told)
        self.told, self.at, self._body = told, now, body

    def leave(self) -> None:
        """Learn that the server is gone."""
        self.node, self.told, self.listed, self._body = "", b"", {}, b""

    def learn_result(self, info: TypeInfo) -> None:
        """Know how a result looks in which everything is 0 or empty; InputError if it cannot."""
        definition = parse_definition(info.type, info.definition)
        size = zeros_size(definition, Encoding.ROS1)
        if size is None or size < _HEAD or definition.md5sum != info.md5sum:
            raise InputError(f"{info.type} is no action's result")
        self.empty_result = bytes(size - _HEAD)

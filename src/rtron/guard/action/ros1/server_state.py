"""What an action's server says: whether it is there, which goals it has, what results look like."""

from collections.abc import Callable

from rtron.errors import InputError
from rtron.guard.transport.common.protocol import TypeInfo
from rtron.messages.common.definition_parser import parse_definition
from rtron.messages.common.encoding import Encoding
from rtron.messages.common.layout import zero_body_size
from rtron.messages.ros1.actions import after_header, read_statuses

# A header without a frame, and a status without id and text: what every result begins with.
_HEAD = 16 + 17


class ServerState:
    """The server as far as it is known; `reaches` tells whether goals and cancels reach a node."""

    def __init__(self, reaches: Callable[[str], bool]) -> None:
        self.node = ""
        self.last_status = b""
        self.last_status_time = 0
        """When the last status array came, ns."""
        self.listed_goals: dict[bytes, int] = {}
        """The state of each goal in it."""
        self.empty_result: bytes | None = None
        self._reaches = reaches
        self._last_body = b""

    @property
    def is_ready(self) -> bool:
        """Whether the server is there, and gets what we send."""
        return bool(self.node) and self._reaches(self.node)

    @property
    def is_visible(self) -> bool:
        """Whether clients may know that the server is there: they will get their answers."""
        return self.is_ready and self.empty_result is not None

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

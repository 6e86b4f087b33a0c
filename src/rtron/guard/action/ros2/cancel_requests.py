"""A client's cancel of several goals: asked of the server one by one, answered as one."""

from collections import defaultdict

from rtron.guard.action.ros2.endpoints import NONE, REJECTED, CancelReply, CancelResponse


class CancelRequest:
    """Gathers the answers for the goals of one cancel, and answers when the last has come.

    A client's cancel never goes to the server as it is: by a stamp, or without an id, it would
    mean the goals of others too.
    """

    def __init__(self, reply: CancelReply) -> None:
        self._reply: CancelReply | None = reply
        self._pending: set[bytes] = set()
        self._canceling: list[tuple[bytes, int]] = []
        self._has_goals = self._is_closed = False

    def add_canceling(self, id: bytes, stamp: int) -> None:
        """Note a goal that will end."""
        self._has_goals = True
        self._canceling.append((id, stamp))

    def add_pending(self, id: bytes) -> None:
        """Wait for what becomes of a goal."""
        self._has_goals = True
        self._pending.add(id)

    def resolve(self, id: bytes, stamp: int, *, is_canceling: bool) -> None:
        """Learn whether a goal that is waited for will end."""
        if id in self._pending:
            self._pending.discard(id)
            if is_canceling:
                self.add_canceling(id, stamp)
            self._reply_if_resolved()

    def close(self) -> None:
        """Know all goals of the cancel; answer as soon as none is open."""
        self._is_closed = True
        self._reply_if_resolved()

    def expire(self) -> None:
        """Answer with what is known."""
        self._pending.clear()
        self._is_closed = True
        self._reply_if_resolved()

    def _reply_if_resolved(self) -> None:
        if self._reply and self._is_closed and not self._pending:
            reply, self._reply = self._reply, None
            is_rejected = self._has_goals and not self._canceling
            reply(CancelResponse(REJECTED if is_rejected else NONE, tuple(self._canceling)))


class CancelRequests:
    """The gatherings that wait for what becomes of a goal."""

    def __init__(self) -> None:
        self._waiting: dict[bytes, list[CancelRequest]] = defaultdict(list)

    def add(self, id: bytes, request: CancelRequest) -> None:
        """Let a gathering wait for what becomes of a goal."""
        request.add_pending(id)
        self._waiting[id].append(request)

    def resolve(self, id: bytes, stamp: int, *, is_canceling: bool) -> None:
        """Tell all that wait for a goal whether it will end."""
        for request in self._waiting.pop(id, ()):
            request.resolve(id, stamp, is_canceling=is_canceling)

"""An action whose turns are shared with goals that come without an id (`followed.py`)."""

from abc import abstractmethod
from collections.abc import Callable

from rtron.guard.core.handover_state import Will
from rtron.guard.core.observations import Senses
from rtron.guard.core.stream import GuardedStream
from rtron.guard.transport.common.protocol import Transport
from rtron.policies.goals.registry import Goal, Goals
from rtron.vocabulary import SERVER, Stream


class SharingAction(GuardedStream):
    """Tells whoever shares its turns when it is free, and when a goal begins.

    Also when one that the server gives itself appears and ends, by its id.
    """

    def __init__(
        self,
        stream: Stream,
        transport: Transport,
        senses: Senses,
        will: Will,
        *,
        dry_run: bool = False,
    ) -> None:
        super().__init__(stream, transport, senses, will, dry_run=dry_run)
        self.goals = Goals()
        self.began: list[Callable[[], None]] = []
        self.freed: list[Callable[[], None]] = []
        self.appeared: list[Callable[[bytes], None]] = []
        self.ended: list[Callable[[bytes], None]] = []
        self.halted: Callable[[str, str], None] = lambda node, why: None
        self._current: Goal | None = None
        self._absent = self._expecting = False
        self._halting = ""

    @property
    def name(self) -> str:
        """The action's name."""
        return self.stream.action

    def expect(self) -> None:
        """Let goals wait for one that the server is about to give itself."""
        self._expecting = True
        self.pipeline.occupy(SERVER, self._transport.now())

    def give_up(self, done: Callable[[], None]) -> None:
        """Expect no goal of the server's own any more, unless there is another after `done`."""
        self._expecting = False
        done()
        if not self._expecting and self._current is None and not self._absent:
            self._free()

    def stop(self, id: bytes, why: str) -> None:
        """Cancel a goal of the server's own, and stop what it moves."""
        goal = self.goals.find(id)
        if goal:
            self._stop(goal, why)
            self._halt()

    @abstractmethod
    def _stop(self, goal: Goal, why: str) -> None:
        """Cancel a goal, if there is a reason."""

    @abstractmethod
    def _serving(self) -> str:
        """Return the node that serves the action, "" while none does."""

    def _halt(self) -> None:
        """Keep the server from moving the robot while it has a goal that was stopped."""
        why = next((goal.stopped for goal in self.goals if goal.stopped), "")
        if why != self._halting:
            self._halting = why
            self.halted(self._serving(), why)

    def _turn_over(self, goal: Goal) -> None:
        """Let the next goal go if this was the one in progress."""
        if goal is self._current:
            self._current = None
            self._free()

    def _free(self) -> None:
        """Let the next goal go: one that the server gives itself, if one waits, then our own."""
        for freed in self.freed:
            freed()
        if not self._expecting:
            self._done(b"")

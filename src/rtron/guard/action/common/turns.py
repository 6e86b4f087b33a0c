"""An action whose turns are shared with goals that come without an id (`followed.py`)."""

from abc import abstractmethod
from collections.abc import Callable

from rtron.guard.core.handover_state import HandoverState
from rtron.guard.core.observations import Observations
from rtron.guard.core.stream import GuardedStream
from rtron.guard.transport.common.protocol import Transport
from rtron.policies.goals.registry import Goal, GoalRegistry
from rtron.vocabulary import SERVER_FLOW, Stream


class TurnSharingStream(GuardedStream):
    """Tells whoever shares its turns when it is free, and when a goal begins.

    Also when one that the server gives itself appears and ends, by its id.
    """

    def __init__(
        self,
        stream: Stream,
        transport: Transport,
        observations: Observations,
        handover: HandoverState,
        *,
        dry_run: bool = False,
    ) -> None:
        super().__init__(stream, transport, observations, handover, dry_run=dry_run)
        self.goals = GoalRegistry()
        self.on_goal_start: list[Callable[[], None]] = []
        self.on_turn_free: list[Callable[[], None]] = []
        self.on_server_goal: list[Callable[[bytes], None]] = []
        self.on_server_goal_end: list[Callable[[bytes], None]] = []
        self.on_goal_stopped: Callable[[str, str], None] = lambda node, why: None
        self._current_goal: Goal | None = None
        self._is_server_absent = self._expects_server_goal = False
        self._halt_reason = ""

    @property
    def name(self) -> str:
        """The action's name."""
        return self.spec.action

    def expect_server_goal(self) -> None:
        """Let goals wait for one that the server is about to give itself."""
        self._expects_server_goal = True
        self.pipeline.occupy(SERVER_FLOW, self._transport.now())

    def stop_expecting(self, on_done: Callable[[], None]) -> None:
        """Expect no goal of the server's own any more, unless there is another after `on_done`."""
        self._expects_server_goal = False
        on_done()
        if (
            not self._expects_server_goal
            and self._current_goal is None
            and not self._is_server_absent
        ):
            self._free_turn()

    def stop_server_goal(self, id: bytes, why: str) -> None:
        """Cancel a goal of the server's own, and stop what it moves."""
        goal = self.goals.find(id)
        if goal:
            self._stop_goal(goal, why)
            self._halt()

    @abstractmethod
    def _stop_goal(self, goal: Goal, why: str) -> None:
        """Cancel a goal, if there is a reason."""

    @abstractmethod
    def _server_node(self) -> str:
        """Return the node that serves the action, "" while none does."""

    def _halt(self) -> None:
        """Keep the server from moving the robot while it has a goal that was stopped."""
        why = next((goal.cancel_reason for goal in self.goals if goal.cancel_reason), "")
        if why != self._halt_reason:
            self._halt_reason = why
            self.on_goal_stopped(self._server_node(), why)

    def _end_turn(self, goal: Goal) -> None:
        """Let the next goal go if this was the one in progress."""
        if goal is self._current_goal:
            self._current_goal = None
            self._free_turn()

    def _free_turn(self) -> None:
        """Let the next goal go: one that the server gives itself, if one waits, then our own."""
        for notify in self.on_turn_free:
            notify()
        if not self._expects_server_goal:
            self._on_action_done(b"")

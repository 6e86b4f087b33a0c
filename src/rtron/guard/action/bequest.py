"""What a guard leaves to the next one about the goals of an action."""

from rtron.guard.core.handover_state import HandoverState
from rtron.guard.transport.common.protocol import Transport
from rtron.policies.goals.registry import GoalRegistry
from rtron.vocabulary import SECOND

_STORE_DELAY = SECOND // 100


class GoalHandover:
    """Keeps the goals of an action in the will, soon after they changed: many may do so at once."""

    def __init__(
        self, name: str, goals: GoalRegistry, handover: HandoverState, transport: Transport
    ) -> None:
        self._name = name
        self._goals = goals
        self._handover = handover
        self._transport = transport
        self._store_scheduled = False

    def restore(self) -> bool:
        """Know the goals that the guard before has left; tell whether there was one."""
        inherited = self._handover.inherited(self._name)
        if inherited:
            self._goals.restore(inherited, self._transport.now())
        return bool(inherited)

    def store_soon(self) -> None:
        """Leave to the next guard whose goals there are."""
        if not self._store_scheduled:
            self._store_scheduled = True
            self._transport.call_at(self._transport.now() + _STORE_DELAY, self.store)

    def store(self) -> None:
        """Leave it before anything else happens: a goal that is answered must not be again."""
        self._store_scheduled = False
        self._handover.store(self._name, self._goals.snapshot())

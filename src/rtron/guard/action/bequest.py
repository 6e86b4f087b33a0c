"""What a guard leaves to the next one about the goals of an action."""

from rtron.guard.core.handover_state import Will
from rtron.guard.transport.common.protocol import Transport
from rtron.policies.goals.registry import Goals
from rtron.vocabulary import SECOND

_KEEP_AFTER = SECOND // 100


class Bequest:
    """Keeps the goals of an action in the will, soon after they changed: many may do so at once."""

    def __init__(self, name: str, goals: Goals, will: Will, transport: Transport) -> None:
        self._name = name
        self._goals = goals
        self._will = will
        self._transport = transport
        self._keeping = False

    def take_over(self) -> bool:
        """Know the goals that the guard before has left; tell whether there was one."""
        kept = self._will.found(self._name)
        if kept:
            self._goals.restore(kept, self._transport.now())
        return bool(kept)

    def keep(self) -> None:
        """Leave to the next guard whose goals there are."""
        if not self._keeping:
            self._keeping = True
            self._transport.call_at(self._transport.now() + _KEEP_AFTER, self.keep_now)

    def keep_now(self) -> None:
        """Leave it before anything else happens: a goal that is answered must not be again."""
        self._keeping = False
        self._will.keep(self._name, self._goals.kept())

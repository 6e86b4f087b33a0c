"""Where the results of goals are waited for, left to the next guard: it answers there."""

from collections.abc import Callable, Mapping

from rtron.guard.action.ros2.endpoints import MOST_UNANSWERED, AnswerResult
from rtron.guard.action.ros2.task import Task
from rtron.guard.core.handover_state import Will
from rtron.guard.transport.common.protocol import Transport
from rtron.vocabulary import SECOND

_KEEP_AFTER = SECOND // 100
_MOST_KEPT = 256

Place = Callable[[str], AnswerResult | None]


class Places:
    """Keeps the open requests for results in the will.

    A client asks for a result once and waits, whoever serves it: a guard that takes the place of
    another can answer, if it knows where.
    """

    def __init__(
        self, name: str, tasks: Mapping[bytes, Task], will: Will, transport: Transport
    ) -> None:
        self._key = f"results {name}"
        self._tasks = tasks
        self._will = will
        self._transport = transport
        self._keeping = False

    def take_over(self, place: Place) -> None:
        """Let the requests to the guard before wait here."""
        found = self._will.found(self._key)
        for id, tokens in found.items() if isinstance(found, dict) else ():
            task = self._tasks.get(bytes.fromhex(id))
            for token in tokens[:MOST_UNANSWERED] if task else ():
                answer = place(token)
                if task and answer:
                    task.wait(answer)

    def keep(self) -> None:
        """Leave to the next guard who waits, soon: many may do so at once."""
        if not self._keeping:
            self._keeping = True
            self._transport.call_at(self._transport.now() + _KEEP_AFTER, self._keep_now)

    def _keep_now(self) -> None:
        self._keeping = False
        waiting = [task for task in self._tasks.values() if task.waiting][:_MOST_KEPT]
        tokens = {task.goal.id.hex(): [each.token for each in task.waiting] for task in waiting}
        self._will.keep(self._key, tokens)

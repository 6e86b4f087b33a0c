"""Where the results of goals are waited for, left to the next guard: it answers there."""

from collections.abc import Callable, Mapping

from rtron.guard.action.ros2.client_replies import GoalTask
from rtron.guard.action.ros2.endpoints import MAX_PENDING_RESULTS, ResultReply
from rtron.guard.core.handover_state import HandoverState
from rtron.guard.transport.common.protocol import Transport
from rtron.vocabulary import SECOND

_STORE_DELAY = SECOND // 100
_MAX_STORED = 256

RestoreReply = Callable[[str], ResultReply | None]


class ResultRequestHandover:
    """Keeps the open requests for results in the will.

    A client asks for a result once and waits, whoever serves it: a guard that takes the place of
    another can answer, if it knows where.
    """

    def __init__(
        self,
        name: str,
        tasks: Mapping[bytes, GoalTask],
        handover: HandoverState,
        transport: Transport,
    ) -> None:
        self._key = f"results {name}"
        self._tasks = tasks
        self._handover = handover
        self._transport = transport
        self._store_scheduled = False

    def restore(self, restore_reply: RestoreReply) -> None:
        """Let the requests to the guard before wait here."""
        inherited = self._handover.inherited(self._key)
        for id, tokens in inherited.items() if isinstance(inherited, dict) else ():
            task = self._tasks.get(bytes.fromhex(id))
            for token in tokens[:MAX_PENDING_RESULTS] if task else ():
                answer = restore_reply(token)
                if task and answer:
                    task.add_result_request(answer)

    def store_soon(self) -> None:
        """Leave to the next guard who waits, soon: many may do so at once."""
        if not self._store_scheduled:
            self._store_scheduled = True
            self._transport.call_at(self._transport.now() + _STORE_DELAY, self._store)

    def _store(self) -> None:
        self._store_scheduled = False
        waiting = [task for task in self._tasks.values() if task.result_replies][:_MAX_STORED]
        tokens = {
            task.goal.id.hex(): [each.token for each in task.result_replies] for task in waiting
        }
        self._handover.store(self._key, tokens)

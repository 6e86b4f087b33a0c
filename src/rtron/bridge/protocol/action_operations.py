"""Goals of actions of ROS 2 that a client sends: their feedback, their results, and cancels.

Who is refused gets a result, too: `result` false, and the reason. Actions of ROS 1 are topics.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import count
from typing import TYPE_CHECKING, Any

from rtron.bridge.protocol.client_state import TokenBucket, message_bucket
from rtron.bridge.protocol.effects import CancelGoal, SendAnswer, SendGoal, SendMessage
from rtron.bridge.protocol.frames import (
    Document,
    encode_frame,
    frame_id,
    name_of,
    split_frame,
    whole_number,
)
from rtron.bridge.rights.document import ActionRight, same_type
from rtron.errors import RTronError, WireError
from rtron.messages.common.json_decoder import decode_json, decode_response

if TYPE_CHECKING:
    from rtron.bridge.protocol.client_state import ActionDefinitions, ClientState

_FEEDBACK_RATE = 20.0
_LARGE = 1 << 62
UNKNOWN, SUCCEEDED = 0, 4
"""States of a goal (action_msgs/GoalStatus)."""


@dataclass(frozen=True, slots=True)
class _OpenGoal:
    """A goal whose result is not there yet."""

    action: str
    id: object
    definitions: ActionDefinitions
    fragment: int
    feedback: TokenBucket | None


class ActionOperations:
    """What one client asks of actions, as far as its rights go."""

    def __init__(self, state: ClientState) -> None:
        self._state = state
        self._may_send = {right.action: right for right in state.client.actions}
        self._rates = {
            right.action: state.rates.keep(f"goal {right.action}", message_bucket(right.rate))
            for right in state.client.actions
        }
        self._numbers = count(1)
        self._open: dict[int, _OpenGoal] = {}

    def send_goal(self, document: Document, now: int, wall_time: int) -> None:
        """Send a goal; its result comes later."""
        action = name_of(document, "action")
        try:
            self._send_goal(action, document, now, wall_time)
        except RTronError as error:
            id = frame_id(document)
            self._answer(action, id, status=UNKNOWN, values=str(error), result=False)
            raise

    def cancel_goal(self, document: Document, now: int, wall_time: int) -> None:
        """Cancel a goal of this client that is not done."""
        del now, wall_time
        action, id = name_of(document, "action"), frame_id(document)
        for number, goal in self._open.items():
            if (goal.action, goal.id) == (action, id) and id is not None:
                self._state.effects.append(CancelGoal(number))
                return
        raise WireError(f"you have no goal {str(id)[:80]!r} of {action[:80]}")

    def deliver_feedback(self, number: int, feedback: bytes, now: int) -> None:
        """Take a goal's feedback, which is sent to who wants it, not too often."""
        goal = self._open.get(number)
        if goal is None or goal.feedback is None or not goal.feedback.take(now):
            return
        values = decode_json(goal.definitions.feedback, self._state.types.encoding, feedback)
        document = {"op": "action_feedback", "action": goal.action, "id": goal.id, "values": values}
        texts = split_frame(encode_frame(document), goal.fragment, f"{goal.action}:{goal.id}")
        self._state.effects.append(SendMessage(tuple(texts)))

    def finish(self, number: int, result: bytes | RTronError) -> None:
        """Take a goal's result with its status, or why it has none."""
        goal = self._open.pop(number, None)
        if goal is None:
            return
        status, values = self._read(goal, result)
        self._answer(
            goal.action,
            goal.id,
            fragment=goal.fragment,
            status=status,
            values=values,
            result=status == SUCCEEDED,
        )

    def _read(self, goal: _OpenGoal, result: bytes | RTronError) -> tuple[int, Any]:
        """Return the status of a goal and the fields of its result, or why there are none."""
        if not isinstance(result, bytes):
            return UNKNOWN, str(result)
        limit = self._state.client.limits.message
        if len(result) > limit:
            return UNKNOWN, f"the result has {len(result)} bytes, you take at most {limit}"
        try:
            read = decode_response(goal.definitions.result, self._state.types.encoding, result)
        except WireError as error:
            return UNKNOWN, str(error)
        return int(read["status"]), read["result"]

    def _send_goal(self, action: str, document: Document, now: int, wall_time: int) -> None:
        right = self._check(action, document, now)
        definitions = self._state.types.action(right.type)
        goal = self._state.encode(
            definitions.goal, document.get("args") or {}, wall_time, frame_id(document)
        )
        if right.approval:
            self._state.check_approval(f"goal of {action}", document.get("args") or {}, now)
        name = self._state.topics.action(self._state.client.node, action)
        wants_feedback = document.get("feedback") is True
        number = next(self._numbers)
        self._open[number] = _OpenGoal(
            action,
            frame_id(document),
            definitions,
            whole_number(document, "fragment_size") or _LARGE,
            message_bucket(_FEEDBACK_RATE) if wants_feedback else None,
        )
        self._state.effects.append(SendGoal(number, name, right.type, goal))

    def _check(self, action: str, document: Document, now: int) -> ActionRight:
        right = self._may_send.get(action)
        if right is None:
            raise WireError(f"{self._state.client.name} may not send goals to {action[:80]}")
        if self._state.ros == 1:
            raise WireError(f"in ROS 1 goals are messages: publish {action}/goal")
        type = str(document.get("action_type") or "")
        if type and not same_type(right.type, type):
            raise WireError(f"{action} is of type {right.type}, not {type[:80]}")
        if frame_id(document) in {goal.id for goal in self._open.values()} - {None}:
            raise WireError("you have a goal of this id")
        limit = self._state.client.limits.calls
        if len(self._open) >= limit:
            raise WireError(f"{limit} of your goals are not done; wait for one, or cancel it")
        if not self._rates[action].take(now):
            raise WireError(f"{action}: more than {right.rate:g} goals a second")
        return right

    def _answer(
        self,
        action: str,
        id: object,
        *,
        fragment: int = _LARGE,
        **fields: Any,  # noqa: ANN401 - JSON
    ) -> None:
        document: Document = {"op": "action_result", "action": action, **fields}
        if id is not None:
            document["id"] = id
        for text in split_frame(encode_frame(document), fragment, f"{action}:{id}"):
            self._state.effects.append(SendAnswer(text))

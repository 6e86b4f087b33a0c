"""Why a tool call is refused: by which rule, what was asked for, and what the limit is."""

from collections import deque
from dataclasses import dataclass
from typing import Any

from rtron.bridge.agents.preview import Judgement
from rtron.errors import WireError

Answer = dict[str, Any]
_MOST_REFUSALS = 50


class CallRefusedError(WireError):
    """A tool call that is refused before anything is sent, or by the bridge."""

    def __init__(
        self, rule: str, reason: str, value: object = None, limit: object = None, by: str = "server"
    ) -> None:
        super().__init__(reason)
        self.rule = rule
        self.value = value
        self.limit = limit
        self.by = by

    @classmethod
    def of(cls, judgement: Judgement) -> "CallRefusedError":
        """Return the refusal of a message that the guard would not let pass as it is."""
        return cls(judgement.rule, judgement.reason, judgement.value, judgement.limits, "policy")

    def answer(self) -> Answer:
        """Return what the caller gets."""
        return {
            "ok": False,
            "refused_by": self.by,
            "rule": self.rule,
            "reason": str(self),
            "value": self.value,
            "limit": self.limit,
        }


@dataclass(frozen=True, slots=True)
class _Refusal:
    at: float
    tool: str
    answer: Answer


class CallRefusals:
    """The refusals of one agent, the newest last."""

    def __init__(self) -> None:
        self._refusals: deque[_Refusal] = deque(maxlen=_MOST_REFUSALS)

    def note(self, tool: str, answer: Answer, wall_time: float) -> None:
        """Note a refusal at a time (s since 1970)."""
        self._refusals.append(_Refusal(wall_time, tool, answer))

    def newest(self, count: int) -> list[Answer]:
        """Return the newest refusals, the last one first."""
        newest = list(self._refusals)[::-1][: max(0, count)]
        return [{"at": each.at, "tool": each.tool, **each.answer} for each in newest]

"""A policy's states and transitions as one table; nothing outside the table changes the state."""

from collections.abc import Mapping
from enum import Enum
from typing import Generic, TypeVar


class TableEnum(Enum):
    """A state, an input or an effect; its value says what it means."""

    # Enum hashes by name, in Python code; tables are read for every message.
    __hash__ = object.__hash__


class TransitionEffect(TableEnum):
    """What a transition does besides changing the state."""

    PASS = "the message passes"  # noqa: S105 (no password)
    HOLD = "the message waits"
    DROP = "the message is dropped"
    MODIFY = "the message goes on changed"
    REISSUE = "what was asked for last goes out again"
    STOP = "the stop wave begins"
    RELEASE = "the next waiting message goes"
    NOTHING = "nothing"
    NEVER = "cannot arise"


_NEVER = TransitionEffect.NEVER
"""Enum looks its members up in Python code; this one is compared for every message."""

State = TypeVar("State", bound=TableEnum)
Input = TypeVar("Input", bound=TableEnum)
TransitionTable = Mapping[tuple[State, Input], tuple[State, TransitionEffect]]


class StateMachine(Generic[State, Input]):
    """The named state of one policy."""

    __slots__ = ("_state", "_table")

    def __init__(self, table: TransitionTable[State, Input], state: State) -> None:
        self._table = table
        self._state = state

    @property
    def state(self) -> State:
        """The state after the last step."""
        return self._state

    def step(self, input: Input) -> TransitionEffect:
        """Make the transition that the table gives for `input`; return its effect."""
        state, effect = self._table[self._state, input]
        if effect is _NEVER:
            raise AssertionError(f"{input.name} cannot arise in {self._state.name}")
        self._state = state
        return effect

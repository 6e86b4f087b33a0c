"""RTron's errors, by who must act.

RTronError
  + InputError      the user: a file or an argument is wrong (path, line, help)
    - PlanError     … the plan is
  + SourceError     the surroundings: a ROS master, a node, a bag does not answer
  + WireError       the other side of a connection: it broke the protocol; never ours to fix
"""

from collections.abc import Collection
from difflib import get_close_matches

_MAX_WORD_LENGTH = 80
_MAX_CHOICES = 24


class RTronError(Exception):
    """Base of all; `help` says what to do about it."""

    def __init__(self, message: str, *, help: str = "") -> None:
        super().__init__(message)
        self.help = help


class InputError(RTronError):
    """A file or an argument that the user gave is wrong; `line` counts from 1, 0 if unknown.

    `reason` is the message without the place.
    """

    def __init__(self, message: str, *, path: str = "", line: int = 0, help: str = "") -> None:
        location = f"{path}:{line}: " if path and line else f"{path}: " if path else ""
        super().__init__(location + message, help=help)
        self.reason = message
        self.path = path
        self.line = line


class PlanError(InputError):
    """The plan is wrong."""


class SourceError(RTronError):
    """Something that RTron reads from, a ROS master for instance, does not answer."""


class WireError(RTronError):
    """A peer sent what the protocol does not allow; its connection is closed."""


def plain_reason(message: str) -> str:
    """Return a message of pydantic without the name of the exception before it."""
    return message.removeprefix("Value error, ").removeprefix("Assertion failed, ")


def suggestion(word: str, known: Collection[str]) -> str:
    """Return "did you mean …?" with the nearest known word, or a short choice if none is near."""
    near = get_close_matches(word[:_MAX_WORD_LENGTH], known, n=1)
    if near:
        return f"did you mean {near[0]}?"
    return (
        f"choose from {', '.join(known)}"
        if len(known) <= _MAX_CHOICES
        else f"none of the {len(known)} is like it"
    )

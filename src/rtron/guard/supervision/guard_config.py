"""What is guarded, and how: the same for every guard that a supervisor starts.

It is read once and handed on in memory, so that a plan that somebody edits meanwhile, or a folder
that is gone, does not keep a guard from coming back.
"""

import hashlib
import pickle
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from rtron.guard.system.sealed_memory import read_memory_file, write_memory_file
from rtron.vocabulary import Mode, Plan, Stream, StreamKind, build_streams


@dataclass(frozen=True, slots=True, kw_only=True)
class GuardConfig:
    """A plan, the master, the other arguments of `run_guard`, and how much is logged."""

    plan: Plan
    master: str
    log_level: str = "INFO"
    options: Mapping[str, Any] = field(default_factory=dict)

    @property
    def digest(self) -> bytes:
        """What tells one plan from another: numbers on the board are known by their place in it."""
        return hashlib.sha256(repr(self.plan).encode()).digest()

    def write_to_memory(self) -> int:
        """Return the descriptor of a file in memory with the configuration."""
        return write_memory_file(pickle.dumps(self))


def read_config(descriptor: int) -> GuardConfig:
    """Return the configuration that a process of ours wrote before it became this one."""
    data = read_memory_file(descriptor)
    config: GuardConfig = pickle.loads(data)  # noqa: S301 - nobody else can have written it
    return config


def is_stoppable(stream: Stream) -> bool:
    """Tell whether messages of a stream can move the robot, and the guard stands in its way."""
    commands = stream.stages[0].settings.kind is StreamKind.COMMAND
    return commands and stream.mode is Mode.ENFORCE


def longest_ramp(plan: Plan) -> int:
    """Return how long the guard of a plan may take until the robot is at rest, ns."""
    return max((each.stop.within for each in stopped_streams(plan)), default=0)


def stopped_streams(plan: Plan) -> tuple[Stream, ...]:
    """Return the streams of a plan that are stopped when the guard dies, in the plan's order."""
    return tuple(filter(is_stoppable, build_streams(plan)))

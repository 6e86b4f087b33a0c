"""Another plan for the next guard: how it comes to the supervisor, and back if it does not serve.

The link process has read and checked it, and leaves a whole configuration in memory; the supervisor
looks at nothing but a number there, and hands the rest on.
"""

import os
import struct
from enum import Enum

from rtron.guard.supervision.fork_server import START_FAILED
from rtron.guard.system.sealed_memory import write_memory_file
from rtron.vocabulary import SECOND

PLAN_TRIAL = 5 * SECOND
"""A guard that has served so long (ns) with another plan keeps it, whatever happens to it then."""
PREPARE_TIMEOUT = 20 * SECOND
"""How long (ns) a guard with another plan may take until it is ready to begin."""
_HEAD = struct.Struct("<QQ")


class PlanSlot:
    """Memory with the newest configuration: its number, its length, itself."""

    def __init__(self, descriptor: int) -> None:
        self.descriptor = descriptor
        self._seen = 0

    def write(self, config: bytes) -> None:
        """Leave a configuration; there is one process that does."""
        number, _ = self._read_head()
        os.pwrite(self.descriptor, config, _HEAD.size)
        os.pwrite(self.descriptor, _HEAD.pack(number + 1, len(config)), 0)

    def take(self) -> bytes:
        """Return a configuration that was not taken yet; b"" if there is none."""
        number, length = self._read_head()
        if number == self._seen:
            return b""
        self._seen = number
        return os.pread(self.descriptor, length, _HEAD.size)

    def _read_head(self) -> tuple[int, int]:
        head: tuple[int, int] = _HEAD.unpack(os.pread(self.descriptor, _HEAD.size, 0))
        return head


def make_plan_slot() -> PlanSlot:
    """Return a slot in which nothing is."""
    descriptor = os.memfd_create("rtron-plan", os.MFD_CLOEXEC)
    os.pwrite(descriptor, _HEAD.pack(0, 0), 0)
    return PlanSlot(descriptor)


class _TrialStep(Enum):
    NONE = "there is one plan"
    PREPARED = "the next guard gets another plan"
    BEGUN = "the guard has another plan, and has yet to show that it serves"


class PlanTrial:
    """The configuration for the next guard, and the former one while another is tried."""

    def __init__(self, config_file: int, slot: PlanSlot | None) -> None:
        self.config_file = self._first = config_file
        self._slot = slot
        self._former = config_file
        self._prepared_at = 0
        self._step = _TrialStep.NONE

    @property
    def slot_files(self) -> list[int]:
        """The descriptors that the link process needs."""
        return [self._slot.descriptor] if self._slot else []

    @property
    def is_prepared(self) -> bool:
        """Whether the guard that runs is to make place for one with another plan."""
        return self._step is _TrialStep.PREPARED

    def take(self, now: int) -> bool:
        """Take another plan, if one has come; each has its trial before the next."""
        if self._slot is None or self._step is not _TrialStep.NONE:
            return False
        config = self._slot.take()
        if not config:
            return False
        self._former, self.config_file = self.config_file, write_memory_file(config)
        self._step, self._prepared_at = _TrialStep.PREPARED, now
        return True

    def give_up(self, now: int) -> bool:
        """Return whether the former plan stays, since no guard gets ready for the other one."""
        is_late = self.is_prepared and now - self._prepared_at > PREPARE_TIMEOUT
        return is_late and self._go_back()

    def begin(self) -> None:
        """Take note that a guard begins with `config_file`."""
        if self._step is _TrialStep.PREPARED:
            self._step = _TrialStep.BEGUN

    def watch(self, served: int) -> None:
        """Take note of how long the guard has served, ns."""
        if self._step is _TrialStep.BEGUN and served >= PLAN_TRIAL:
            self._end()

    def guard_ended(self, code: int) -> bool:
        """Take note of the guard's exit code; return whether the former plan is back.

        A guard that the system could not start says nothing about its plan.
        """
        is_tried = self._step is _TrialStep.BEGUN and code != START_FAILED
        return is_tried and self._go_back()

    def _go_back(self) -> bool:
        self.config_file, self._former = self._former, self.config_file
        self._end()
        return True

    def _end(self) -> None:
        """Keep `config_file`; the first one is the link process's, too."""
        if self._former != self._first:
            os.close(self._former)
        self._former, self._step = self.config_file, _TrialStep.NONE

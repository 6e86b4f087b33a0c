"""How urgent a process of the guard is to the system's scheduler."""

import logging
import os

log = logging.getLogger(__name__)


def lower_priority(nice: int) -> None:
    """Let other processes go first (sched(7), SCHED_BATCH); go on where the system forbids it."""
    try:
        os.nice(nice)
        os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    except OSError as error:
        log.info("this process keeps its priority: %s", error)

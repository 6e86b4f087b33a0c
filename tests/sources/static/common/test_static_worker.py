"""What a worker gives a task: a limit that is processor time, and memory for its frames."""

import time
from resource import RUSAGE_SELF, getrusage

import pytest

from rtron.sources.static.common.worker import TimeUpError, processor_time_limit, with_frame_space

LIMIT = 0.02
CALLS = 200
DEPTHS = range(300)


def work() -> None:
    while True:
        pass


def test_waiting_for_the_processor_does_not_count():
    with processor_time_limit(LIMIT):
        time.sleep(2 * LIMIT)


def test_work_ends_at_the_limit():
    with pytest.raises(TimeUpError), processor_time_limit(LIMIT):
        work()


def test_what_waits_without_end_is_ended():
    with pytest.raises(TimeUpError), processor_time_limit(LIMIT):
        time.sleep(1000 * LIMIT)


def descend(depth: int) -> None:
    if depth:
        descend(depth - 1)


def page_faults(depth: int) -> int:
    """Return the page faults of many calls that begin at a depth."""
    if depth:
        return page_faults(depth - 1)
    before = getrusage(RUSAGE_SELF).ru_minflt
    for _ in range(CALLS):
        descend(3)
    return getrusage(RUSAGE_SELF).ru_minflt - before


def test_no_depth_maps_memory_with_each_call():
    @with_frame_space
    def most() -> int:
        return max(map(page_faults, DEPTHS))

    assert most() < CALLS // 2

"""What a call costs, in processor time, which other processes change less than the wall clock."""

from functools import cache
from time import process_time

_LONG_S = 0.5
"""What takes longer is hardly disturbed by what else the machine does."""


def cpu_seconds(call, *arguments):
    """Return the processor time (s) of the quickest of three calls, of one that takes long."""

    def once():
        start = process_time()
        call(*arguments)
        return process_time() - start

    first = once()
    return first if first > _LONG_S else min(first, once(), once())


def growth(call, small, large):
    """Return how many times as long a call takes with the large argument as with the small one."""
    return cpu_seconds(call, large) / cpu_seconds(call, small)


def work_units(call, *arguments):
    """Return what one call gives, and how many times as long it takes as a fixed piece of work.

    A unit is about a tenth of a second where a machine is idle: bounds grow with slow machines, and
    with what else they do meanwhile.
    """
    start = process_time()
    result = call(*arguments)
    taken = process_time() - start
    return result, taken / (_first_unit() if taken < _LONG_S else max(_first_unit(), _unit()))


@cache
def _first_unit():
    return _unit()


def _unit():
    return cpu_seconds(lambda: sum(number * number for number in range(1_000_000)))

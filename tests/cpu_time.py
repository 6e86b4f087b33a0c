"""What a call costs, in processor time, which other processes change less than the wall clock."""

from time import process_time


def cpu_seconds(call, *arguments):
    """Return the processor time (s) of the quickest of three calls."""

    def once():
        start = process_time()
        call(*arguments)
        return process_time() - start

    return min(once() for _ in range(3))


def growth(call, small, large):
    """Return how many times as long a call takes with the large argument as with the small one."""
    return cpu_seconds(call, large) / cpu_seconds(call, small)

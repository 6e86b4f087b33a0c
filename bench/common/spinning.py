"""Processes that keep cores busy: `python -m bench.common.spinning` spins, for an hour at most."""

import signal
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

from bench.common.testbed import Testbed, python, running

_LIMIT_S = 3600


@contextmanager
def spinning(testbed: Testbed, number: int) -> Iterator[None]:
    """Let this many processes spin until the end of the block."""
    with ExitStack() as stack:
        for _ in range(number):
            stack.enter_context(running(testbed, python("bench.common.spinning")))
        yield


if __name__ == "__main__":
    signal.alarm(_LIMIT_S)
    while True:
        pass

"""The wall clock of the service, passed in so that tests can set it."""

import time
from collections.abc import Callable

Clock = Callable[[], int]
"""Returns the wall clock, ns since 1970."""

wall_clock: Clock = time.time_ns

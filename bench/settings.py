"""How much is measured; the environment can shorten it for a trial."""

import os


def _number(name: str, default: int) -> int:
    return int(os.environ.get(f"RTRON_BENCH_{name}") or default)


RUNS = _number("RUNS", 5)
"""Interleaved runs of each way."""
HOP_MESSAGES = _number("HOP_MESSAGES", 1000)
"""Messages of a run at 200 Hz."""
LOAD_SECONDS = _number("LOAD_SECONDS", 10)
"""How long a load lasts, s."""
MESSAGES = _number("MESSAGES", 10_000_000)
"""Messages that memory is watched over."""
MEMORY_SECONDS = _number("MEMORY_SECONDS", 600)
"""How long memory is watched at most, s."""
ENDPOINTS = _number("ENDPOINTS", 1_000_000)
"""Endpoints of the large graph."""
SILENCES = _number("SILENCES", 200)
"""How often a stream falls silent, idle and busy."""
VIOLATIONS = _number("VIOLATIONS", 10_000_000)
"""Velocities that are generated."""
REPLAYED = _number("REPLAYED", 200_000)
"""Messages of a bag that is replayed."""

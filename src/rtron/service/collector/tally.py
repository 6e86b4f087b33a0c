"""What the collector has done since the service began, for metrics."""

from dataclasses import dataclass


@dataclass(slots=True)
class Tally:
    """Counters; `refused` are connections that said what is no message, `slow` those too slow.

    `repeated` are events that came again and were stored already; `batches` and `seconds` tell
    how many transactions it took, and how long (s); `failures` are batches that could not be
    stored, `forgotten` are events that retention deleted.
    """

    connected: int = 0
    unauthorised: int = 0
    replaced: int = 0
    refused: int = 0
    slow: int = 0
    stored: int = 0
    repeated: int = 0
    batches: int = 0
    seconds: float = 0.0
    failures: int = 0
    forgotten: int = 0

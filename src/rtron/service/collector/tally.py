"""What the collector has done since the service began, for metrics."""

from dataclasses import dataclass


@dataclass(slots=True)
class CollectorCounters:
    """Counters; `protocol_violations` are connections that said what is no message, `slow_connections` those too slow.

    `duplicate_events` are events that came again and were stored already; `transactions` and `transaction_seconds` tell
    how many transactions it took, and how long (s); `failed_batches` are batches that could not be
    stored, `pruned_events` are events that retention deleted.
    """

    connections: int = 0
    unauthorised_connections: int = 0
    replaced_connections: int = 0
    protocol_violations: int = 0
    slow_connections: int = 0
    stored_events: int = 0
    duplicate_events: int = 0
    transactions: int = 0
    transaction_seconds: float = 0.0
    failed_batches: int = 0
    pruned_events: int = 0

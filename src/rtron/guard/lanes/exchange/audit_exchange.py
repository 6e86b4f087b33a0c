"""What the command process and the audit in the bulk process tell each other."""

from collections.abc import Mapping
from dataclasses import dataclass, field

MAX_ALARMS = 256
"""How many alarms are told that stop streams, and how many that stop nothing."""
StoppedTopics = tuple[str, ...]
"""The streams that an alarm stops."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NodesReport:
    """The nodes of the command process in the graph.

    ROS 1: the `uris` of its nodes, their TCPROS `port`, and who has subscribed each private
    output. ROS 2: its `participant`, the first bytes of the GIDs, the supervisor's, and the
    `former_participants` of processes of the guard that have ended.
    """

    uris: Mapping[str, str] = field(default_factory=dict)
    port: int = 0
    subscribers: Mapping[str, frozenset[str]] = field(default_factory=dict)
    participant: bytes = b""
    former_participants: frozenset[bytes] = frozenset()
    supervisor_participant: bytes = b""

"""What the guard reports of itself, as a client of the bridge hears it: the state of the moment.

`/diagnostics` comes once a second and tells rules, frame rates, stops and verdicts; the status of
each lease comes with every change. What was not heard lately is not known.
"""

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from rtron.vocabulary import SECOND

HARDWARE = "rtron"
"""What the guard's entries in `/diagnostics` have as their `hardware_id`."""
KNOWN_FOR = 3 * SECOND
"""So long an entry of the diagnostics counts, ns."""
_PREFIX = "rtron: "
_STREAM = re.compile(r"(?P<topic>/\S*) \((?P<nodes>[^)]*)\)")
_STOPPING = "stopping: "
_LATCHED = ("latched stop",)
_WARN, _ERROR = 1, 2


@dataclass(frozen=True, slots=True)
class ReportEntry:
    """One entry of the diagnostics, and when it was heard (ns)."""

    level: int
    message: str
    values: Mapping[str, str]
    at: int


@dataclass(slots=True)
class GuardReport:
    """The newest of what was heard; times are ns of one steady clock."""

    _entries: dict[str, ReportEntry] = field(default_factory=dict)
    _leases: dict[str, Mapping[str, Any]] = field(default_factory=dict)
    last_report_at: int = 0
    """When the diagnostics were heard last, 0 if never."""

    def take_diagnostics(self, message: Mapping[str, Any], now: int) -> None:
        """Take a DiagnosticArray; entries of other programs are left out."""
        for status in message.get("status", ()):
            name = str(status.get("name", ""))
            if status.get("hardware_id") == HARDWARE and name.startswith(_PREFIX):
                values = {str(each["key"]): str(each["value"]) for each in status["values"]}
                entry = ReportEntry(int(status["level"]), str(status["message"]), values, now)
                self._entries[name.removeprefix(_PREFIX)] = entry
                self.last_report_at = now

    def take_lease(self, name: str, status: Mapping[str, Any]) -> None:
        """Take the status of a lease."""
        self._leases[name] = status

    def entries(self, now: int) -> dict[str, ReportEntry]:
        """Return the entries that count at `now`, by name."""
        return {name: each for name, each in self._entries.items() if now - each.at < KNOWN_FOR}

    def is_known(self, now: int) -> bool:
        """Tell whether the guard has reported lately."""
        return bool(self.last_report_at) and now - self.last_report_at < KNOWN_FOR

    def reported_at(self, topic: str) -> int:
        """Return when the guard has last reported of a guarded topic, of anything for "" (ns)."""
        entry = self.stream(topic, self.last_report_at) if topic else None
        return entry.at if entry else 0 if topic else self.last_report_at

    def holder(self, lease: str) -> str:
        """Return who holds a lease, "" if nobody does or nobody knows."""
        return str(self._leases.get(lease, {}).get("holder", ""))

    def grant_began(self, lease: str) -> float:
        """Return since when the holder has the lease (s of the wall clock), 0 if nobody has it."""
        return float(self._leases.get(lease, {}).get("since") or 0.0)

    def lease_status(self, lease: str) -> Mapping[str, Any]:
        """Return what the guard last said of a lease, nothing if it has said nothing."""
        return self._leases.get(lease, {})

    def stream(self, topic: str, now: int) -> ReportEntry | None:
        """Return the entry of a guarded topic."""
        found = ((_STREAM.fullmatch(name), each) for name, each in self.entries(now).items())
        return next((each for match, each in found if match and match["topic"] == topic), None)

    def rule_blocks(self, rule: str, now: int) -> bool | None:
        """Tell whether a rule of the mission blocks; None if that is not known."""
        entry = self.entries(now).get(f"rule {rule}")
        return None if entry is None else entry.level >= _WARN

    def frame_rate(self, monitor: str, now: int) -> float:
        """Return the frames a second of an fps_monitor, 0 if it is silent or not known."""
        entry = self.entries(now).get(monitor)
        try:
            return float(entry.values.get("fps", "0")) if entry else 0.0
        except ValueError:
            return 0.0

    def stop_reason(self, topic: str, now: int) -> str:
        """Return why a topic is kept stopped until a person acts, "" if it is not.

        A stop that ends by itself, since a source is silent for instance, is none.
        """
        entries = self.entries(now)
        emergency = entries.get("emergency stop")
        if emergency and "(dry run" not in emergency.message:
            return emergency.message
        stream = self.stream(topic, now)
        text = stream.message.partition(_STOPPING)[2] if stream else ""
        if text.startswith(_LATCHED):
            return text
        alarms = (each for name, each in entries.items() if name.startswith("alarm "))
        return next((each.message for each in alarms if each.values.get("topic") == topic), "")


def read_lease_message(message: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return what a String with JSON in it says of a lease, nothing if it is none."""
    try:
        found = json.loads(str(message.get("data")))
    except ValueError:
        return {}
    return found if isinstance(found, dict) else {}

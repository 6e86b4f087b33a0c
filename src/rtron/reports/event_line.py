"""An event of a guard on one line."""

from collections.abc import Mapping
from datetime import datetime
from typing import Any

from rtron.sanitize import sanitize

_SECOND = 1_000_000_000
_MARKS = {"info": " ", "warning": "!", "error": "E"}


def event_line(event: Mapping[str, Any]) -> str:
    """Return an event, as the API shows it, on one line that a terminal survives; local time."""
    at = datetime.fromtimestamp(event["at"] // _SECOND).astimezone()
    what = event["decision"] or event["kind"]
    source = " ".join(filter(None, (event["node"], event["topic"], event["flow"])))
    who = f" by {event['publisher']}" if event["publisher"] else ""
    reason = f": {event['reason']}" if event["reason"] else ""
    mark = _MARKS.get(event["level"], "?")
    head = f"{at:%m-%d %H:%M:%S} {mark} {event['robot']} {what}"
    return sanitize(f"{head} {source}{who}{reason}".rstrip())

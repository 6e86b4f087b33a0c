"""A replay as JSON, for other programs."""

from dataclasses import asdict
from typing import Any

from rtron.vocabulary import REPLAY_SCHEMA, SECOND, Replay


def replay_to_json(replay: Replay) -> dict[str, Any]:
    """Return a replay as a document; times are in seconds after the first message."""
    return {
        "schema": REPLAY_SCHEMA,
        "messages": replay.messages,
        "duration": replay.duration / SECOND,
        "streams": [asdict(stream) for stream in replay.streams],
        "changes": [{**asdict(each), "at": each.at / SECOND} for each in replay.changes],
        "changes_left_out": replay.unseen,
        "notes": list(replay.notes),
    }

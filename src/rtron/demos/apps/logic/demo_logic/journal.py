"""Messages that a node sent or received, as JSON lines in the folder of DEMO_JOURNAL."""

import json
import os
import time
from collections.abc import Sequence
from pathlib import Path
from threading import Lock


class Journal:
    """The lines of one node, in `<node name>.jsonl`; without DEMO_JOURNAL none are written.

    The file exists from the start of the node, which shows that it runs.
    """

    def __init__(self, node: str, folder: str | None = None) -> None:
        folder = folder or os.environ.get("DEMO_JOURNAL")
        name = node.strip("/").replace("/", "_")
        self._lock = Lock()
        self._path = Path(folder, f"{name}.jsonl") if folder else None
        if self._path:
            self._path.touch()

    def sent(self, topic: str, value: Sequence[float]) -> None:
        """Note a malicious message that the node is sending."""
        self._write("sent", topic, value)

    def received(self, topic: str, value: Sequence[float]) -> None:
        """Note a message that has arrived."""
        self._write("received", topic, value)

    def _write(self, what: str, topic: str, value: Sequence[float]) -> None:
        if self._path is None:
            return
        line = {"wall": time.time(), "what": what, "topic": topic, "value": list(value)}
        with self._lock, self._path.open("a", encoding="utf-8") as file:  # topics have threads
            file.write(json.dumps(line) + "\n")

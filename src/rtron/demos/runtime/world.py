"""The world process, and the runner's connection to it."""

import secrets
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from rtron.demos.runtime.processes import Command, ProcessGroup
from rtron.demos.world.client import WorldClient

_LIMIT = 60.0


@contextmanager
def run_world(
    processes: ProcessGroup, socket: Path, speed: float, environ: Mapping[str, str]
) -> Iterator[WorldClient]:
    """Run a world of simulated seconds a second `speed`, in the caller's Python; give its owner.

    SourceError if it does not come up, with what it said.
    """
    key = secrets.token_hex()
    command: Command = [sys.executable, "-m", "rtron.demos.world", socket, "--speed", f"{speed:g}"]
    with (
        processes.running(command, {**environ, "DEMO_KEY": key}, name="world"),
        WorldClient.connect(socket, key, _LIMIT) as owner,
    ):
        yield owner

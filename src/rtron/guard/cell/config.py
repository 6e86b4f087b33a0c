"""What a cell is made of: handed to its processes in memory, as the guard's configuration is."""

import pickle
from dataclasses import dataclass

from rtron.guard.cell.isolation import Gap, Outside
from rtron.guard.system.sealed_memory import read_memory_file, write_memory_file
from rtron.vocabulary import CellManifest, Plan

READY, REFUSED = b"ready", b"refused"
"""What the cell tells the gateway: that its node can start, or that it will not."""
START = b"start"
"""What the gateway tells the cell: to start the node. A number is a signal for the node."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CellConfig:
    """A cell before it is there.

    `user`, `group` and `groups` are those of the node, and `home` its home folder, empty for one
    that ends with the cell. `identity` tells one cell from the next. `guard_users` may enter.
    `allowed` are gaps that the user knows of.
    """

    plan: Plan
    manifest: CellManifest
    command: tuple[str, ...]
    outside: Outside
    user: int
    group: int
    identity: bytes
    groups: tuple[int, ...] = ()
    home: str = ""
    guard_users: tuple[int, ...] = (0,)
    allowed: frozenset[Gap] = frozenset()
    log_level: str = "INFO"

    def write_to_memory(self) -> int:
        """Return the descriptor of a file in memory with the configuration."""
        return write_memory_file(pickle.dumps(self))


def read_cell_config(descriptor: int) -> CellConfig:
    """Return the configuration that the gateway wrote."""
    config: CellConfig = pickle.loads(read_memory_file(descriptor))  # noqa: S301 - the gateway is our parent
    return config

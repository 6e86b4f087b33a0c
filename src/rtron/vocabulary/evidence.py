"""Where facts come from."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Evidence:
    """Where a fact was read: a file (or an address, for a running app) and a line (from 1)."""

    file: str
    line: int = 0

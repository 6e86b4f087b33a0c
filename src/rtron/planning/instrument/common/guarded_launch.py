"""What instrumenting a launch file gives: files to write, and what they do not achieve."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True, slots=True, kw_only=True)
class PlacedRemap:
    """A remap that the guarded launch puts on a node: `written` now leads to `target`.

    `node` is the launched node (a nodelet's loader, where it is one), `topic` the guarded topic.
    """

    node: str
    topic: str
    written: str
    target: str

    @property
    def is_placeable(self) -> bool:
        """Whether a launch file can say it: a name that changes at every start it cannot."""
        return "*" not in self.written + self.target


@dataclass(frozen=True, slots=True, kw_only=True)
class EnforcementGap:
    """A node of the plan (`what`) that the guarded launch does not close, and why.

    `accepted` says that the plan's `accept_unenforceable` names it.
    """

    what: str
    why: str
    accepted: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class GuardedLaunch:
    """A guarded launch: `launch` is its file, `folder` holds all others of `files`.

    A file whose text begins with `#!` is executable. `copies` of scripts and `links`, all below
    `folder`, are mapped to what they are made from. `notes` are worth knowing and no failure.
    """

    launch: Path
    folder: Path
    files: Mapping[Path, str]
    copies: Mapping[Path, Path] = field(default_factory=dict)
    links: Mapping[Path, Path] = field(default_factory=dict)
    remaps: tuple[PlacedRemap, ...] = ()
    unenforceable: tuple[EnforcementGap, ...] = ()
    notes: tuple[str, ...] = ()

"""What instrumenting a launch file gives: files to write, and what they do not achieve.

roslaunch looks a node's executable up in the packages it knows itself, whatever `<env>` the node
has. So the guard is a `launch-prefix` of a node that is installed wherever roslaunch is, rosout;
the prefix does not run what it prefixes.
"""

import shlex
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rtron.vocabulary import GUARD_NODE


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


GUARD_COMMAND = (sys.executable, "-m", "rtron", "guard")
GUARD_SCRIPT = "guard"
PLAN_FILE = "rtron.yaml"
GRAPH_FILE = "graph.json"
_OPTIONS = {PLAN_FILE: "--plan", GRAPH_FILE: "--graph"}


def guard_element(folder: str) -> tuple[str, ...]:
    """Return the lines that start the guard's script in `folder`, beside the launch file.

    Standing first and in the root namespace, it inherits no remap, parameter or machine.
    """
    prefix = f"""launch-prefix='"$(dirname)/{folder}/{GUARD_SCRIPT}"'"""
    return (
        "<!-- The guard. rosout is only the package that roslaunch always finds:",
        f"     {GUARD_SCRIPT} does not run it. -->",
        f'<node pkg="rosout" type="rosout" name="{GUARD_NODE.strip("/")}" ns="/" {prefix}',
        '      respawn="true" output="screen"/>',
    )


@dataclass(frozen=True, slots=True)
class GuardFiles:
    """What the guard of a launch reads: its plan, and the app's graph to check it against.

    `command` runs the guard. Without a `graph` it cannot know whether the plan fits.
    """

    plan: str
    graph: str = ""
    command: Sequence[str] = GUARD_COMMAND

    def texts(self, note: str = "") -> dict[str, str]:
        """Return the files by name, with the script that runs the guard; `note` stands in it."""
        texts = {PLAN_FILE: self.plan} | ({GRAPH_FILE: self.graph} if self.graph else {})
        options = (f' {_OPTIONS[name]} "${{0%/*}}/{name}"' for name in texts)
        script = f"#!/bin/sh\n{note}exec {shlex.join(self.command)}{''.join(options)}\n"
        return {GUARD_SCRIPT: script, **texts}

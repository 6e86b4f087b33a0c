"""What instrumenting a launch file gives: files to write, and what they do not achieve.

roslaunch looks a node's executable up in the packages it knows itself, whatever `<env>` the node
has. So the guard is a `launch-prefix` of a node that is installed wherever roslaunch is, rosout;
the prefix does not run what it prefixes.
"""

import os
import shlex
import shutil
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from rtron.errors import InputError
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


_SCRIPT_MODE = 0o755
_TEXT_MODE = 0o644


def write_guarded_launch(guarded: GuardedLaunch) -> None:
    """Write the files; the launch file comes last, and an earlier guarded launch is replaced.

    Raise InputError if the folder is there and no earlier guarded launch's, or for no access.
    """
    launch, folder = guarded.launch, guarded.folder
    if folder.exists() and not all((folder / name).is_file() for name in (GUARD_SCRIPT, PLAN_FILE)):
        help = "choose another name for the guarded launch"
        raise InputError("is there already and not RTron's", path=str(folder), help=help)
    try:
        launch.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".rtron-", dir=launch.parent) as stage:
            _stage(guarded, Path(stage))
            _publish(Path(stage), launch, folder)
    except OSError as error:
        raise InputError(f"cannot be written: {error.strerror}", path=str(launch)) from None


def _stage(guarded: GuardedLaunch, stage: Path) -> None:
    top = guarded.launch.parent
    for path, text in guarded.files.items():
        staged = _with_folder(stage / path.relative_to(top))
        staged.write_bytes(text.encode(errors="surrogateescape"))
        staged.chmod(_SCRIPT_MODE if text.startswith("#!") else _TEXT_MODE)
    for path, original in guarded.copies.items():
        staged = _with_folder(stage / path.relative_to(top))
        shutil.copyfile(original, staged)
        staged.chmod(_SCRIPT_MODE)
    for path, original in guarded.links.items():
        _with_folder(stage / path.relative_to(top)).symlink_to(original)


def _with_folder(path: Path) -> Path:
    """Return a path whose folder is there."""
    path.parent.mkdir(parents=True, exist_ok=True)
    return path


def _publish(stage: Path, launch: Path, folder: Path) -> None:
    """Move what is staged to its place; what it replaces goes away with the stage."""
    if folder.exists():
        folder.rename(stage / "replaced")
    (stage / folder.name).rename(folder)
    os.replace(stage / launch.name, launch)  # noqa: PTH105 - says what it does

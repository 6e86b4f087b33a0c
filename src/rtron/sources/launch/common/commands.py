"""`command=` of a `<param>`: what would run, recognised and never run.

Two are understood, `cat FILE` and xacro with its mappings (ROS wiki: roslaunch/XML/param).
"""

import shlex
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeAlias

from rtron.vocabulary import UnknownValue

DescribeRobot: TypeAlias = Callable[[Path, Mapping[str, str]], str | UnknownValue]
"""Evaluates a xacro file with its mappings to a robot description."""

_XACRO = frozenset({"xacro", "xacro.py"})
_PREFIX_WORDS = {"env": 1, "python": 1, "python2": 1, "python3": 1, "rosrun": 2, "ros2": 3}
"""What may stand before a program, and how many words it takes: `ros2 run PACKAGE`."""
_VALUED_OPTIONS = frozenset({"-o", "--output", "--deps", "--verbosity"})


@dataclass(frozen=True, slots=True, kw_only=True)
class XacroCommand:
    """A run of xacro that writes the description to its standard output."""

    file: str
    mappings: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class CatCommand:
    """A run of `cat` for one file."""

    file: str


def recognise_command(command: str) -> XacroCommand | CatCommand | None:
    """Return what a command line does, None if it is not of a kind that is understood."""
    try:
        words = shlex.split(command)
    except ValueError:
        return None
    names = [word.rpartition("/")[2] for word in words]
    if names[:1] == ["cat"] and len(words) == len(["cat", "FILE"]):
        return None if words[1].startswith("-") else CatCommand(file=words[1])
    while names and names[0] in _PREFIX_WORDS:
        skipped = _PREFIX_WORDS[names[0]]
        names, words = names[skipped:], words[skipped:]
    return _xacro(words[1:]) if names[:1] and names[0] in _XACRO else None


def _xacro(words: list[str]) -> XacroCommand | None:
    mappings = [word for word in words if ":=" in word]
    files = [word for word in words if ":=" not in word and not word.startswith("-")]
    if len(files) != 1 or not _VALUED_OPTIONS.isdisjoint(words):
        return None
    pairs = (word.split(":=", 1) for word in mappings)
    return XacroCommand(
        file=files[0], mappings={name.strip(): value.strip() for name, value in pairs}
    )

"""A LaunchTree: what a launch file starts, and which element of which file starts it."""

from collections.abc import Iterator
from dataclasses import dataclass

from rtron.vocabulary.graph import Unresolved


@dataclass(frozen=True, slots=True, kw_only=True)
class Remap:
    """A remap in force at a node: both names as they resolve there, and `from` as written."""

    written: str
    declared: str
    target: str


@dataclass(frozen=True, slots=True, kw_only=True)
class LaunchNode:
    """A `<node>` or `<test>` that starts: its full name, what it runs and the remaps it inherits.

    `element` counts the elements of its file in document order, the root being 0. `anonymous`
    means that the name changes at every start (`$(anon …)`); `name` then is a pattern with `*`.
    """

    name: str
    package: str
    type: str
    args: str = ""
    remaps: tuple[Remap, ...] = ()
    element: int
    line: int = 0
    anonymous: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class LaunchInclude:
    """An `<include>` that is taken, and the file as it is seen from there."""

    element: int
    file: "LaunchFile"


@dataclass(frozen=True, slots=True, kw_only=True)
class LaunchFile:
    """One inclusion of a launch file; the same file included twice stands here twice."""

    path: str
    nodes: tuple[LaunchNode, ...] = ()
    includes: tuple[LaunchInclude, ...] = ()

    def walk(self) -> Iterator["LaunchFile"]:
        """Yield this file and every file below it, in document order."""
        yield self
        for include in self.includes:
            yield from include.file.walk()


@dataclass(frozen=True, slots=True, kw_only=True)
class LaunchTree:
    """A launch file with everything it includes, evaluated for one set of arguments."""

    root: LaunchFile
    unresolved: tuple[Unresolved, ...] = ()

    def nodes(self) -> tuple[LaunchNode, ...]:
        """Return every node that the launch starts."""
        return tuple(node for file in self.root.walk() for node in file.nodes)

"""A LaunchTree: what a launch file starts and sets, and which element of which file does."""

from collections.abc import Iterator
from dataclasses import dataclass, field

from rtron.vocabulary.evidence import Evidence
from rtron.vocabulary.graph import UnresolvedItem
from rtron.vocabulary.parameters import ParameterTree
from rtron.vocabulary.wiring import WiringFact


def resolve_name(name: str, node: str) -> str:
    """Return a name as it resolves at a node, before remapping (ROS wiki: Names).

    `/absolute` stays, `~private` stands below the node, everything else beside it.
    """
    if name.startswith("/"):
        return canonical_name(name)
    parent = node if name.startswith("~") else node.rpartition("/")[0]
    return canonical_name(f"{parent}/{name.removeprefix('~')}")


def canonical_name(name: str) -> str:
    """Return a name without doubled or trailing slashes (ROS wiki: Names)."""
    root = "/" if name.startswith("/") else ""
    return root + "/".join(part for part in name.split("/") if part)


@dataclass(frozen=True, slots=True, kw_only=True)
class Remap:
    """A remap in force at a node: both its names as written, and as they resolve there."""

    written_source: str
    written_target: str
    source: str
    target: str


@dataclass(frozen=True, slots=True, kw_only=True)
class LaunchRemap:
    """A `<remap>` of a launch file, its names as they resolve where it stands."""

    source: str
    target: str
    evidence: Evidence


@dataclass(frozen=True, slots=True, kw_only=True)
class LaunchNode:
    """A `<node>` or `<test>` that starts: its full name, what it runs, the remaps in force.

    `element_index` counts the elements of its file in document order, the root being 0. `anonymous`
    means that the name changes at every start (`$(anon …)`); `name` then is a pattern with `*`.
    `environ` has the `<env>` in force, the last of a name counts. `conditional` means that it
    starts under a condition that is not known. In ROS 2, where the first remap of a name counts,
    the first `inherited_remap_count` ones are not the element's own.
    """

    name: str
    package: str
    type: str
    args: str = ""
    remaps: tuple[Remap, ...] = ()
    environ: tuple[tuple[str, str], ...] = ()
    element_index: int
    line: int = 0
    anonymous: bool = False
    conditional: bool = False
    inherited_remap_count: int = 0

    @property
    def namespace(self) -> str:
        """The namespace in which the node's relative names resolve."""
        return self.name.rpartition("/")[0] or "/"


@dataclass(frozen=True, slots=True, kw_only=True)
class LaunchInclude:
    """An `<include>` that is taken, and the file as it is seen from there.

    `element_index` counts the elements of the including file in document order, the root being 0.
    `evaluated_name` is the file's name as it is evaluated there.
    """

    element_index: int
    evaluated_name: str
    file: "LaunchFile"


@dataclass(frozen=True, slots=True, kw_only=True)
class LaunchFile:
    """One inclusion of a launch file; the same file included twice stands here twice.

    `path` is absolute and spelled as roslaunch opens it.
    """

    path: str
    nodes: tuple[LaunchNode, ...] = ()
    includes: tuple[LaunchInclude, ...] = ()

    def walk(self) -> Iterator["LaunchFile"]:
        """Yield this file and every file below it, in document order."""
        yield self
        for include in self.includes:
            yield from include.file.walk()


@dataclass(frozen=True, slots=True, kw_only=True)
class LaunchInput:
    """An argument that decides what a launch starts, under which names; or an environment variable.

    `values` are those for which a LaunchTree holds; None stands for not being given.
    """

    name: str
    values: tuple[str | None, ...]
    environment: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class LaunchTree:
    """A launch file with everything it includes, evaluated for one set of arguments.

    `parameters` is the parameter server once everything has started; a value that cannot be
    known is an UnknownValue. `remaps_behind_all` stand behind all that starts in their scope, so
    that no node gets them. `inputs` are what the tree depends on, so far as that is tracked,
    `declared` the arguments that its files declare.
    """

    root: LaunchFile
    unresolved: tuple[UnresolvedItem, ...] = ()
    inputs: tuple[LaunchInput, ...] = ()
    declared: frozenset[str] = frozenset()
    parameters: ParameterTree = field(default_factory=ParameterTree)
    remaps_behind_all: tuple[LaunchRemap, ...] = ()
    wiring: tuple[WiringFact, ...] = ()

    def nodes(self) -> tuple[LaunchNode, ...]:
        """Return every node that the launch starts."""
        return tuple(node for file in self.root.walk() for node in file.nodes)

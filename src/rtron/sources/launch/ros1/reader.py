"""A roslaunch file and all it includes, as a LaunchTree; nothing is executed."""

import os
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.launch.common.commands import DescribeRobot
from rtron.sources.launch.common.errors import MissingArgumentError
from rtron.sources.launch.common.packages import PackageIndex
from rtron.sources.launch.common.xml_document import LaunchDocument, line_of
from rtron.sources.launch.ros1.file_reader import LaunchFileReader
from rtron.sources.launch.ros1.loader_context import root_context
from rtron.sources.launch.ros1.parameter_server import LaunchFileCache, LoadState, ParameterServer
from rtron.vocabulary import LaunchTree, UnresolvedItem

_TOOL_PACKAGES = {"xacro": Path("xacro")}
"""Packages that a launch names only to run their programs: they need not be there."""


def read_launch(
    path: Path,
    args: Mapping[str, str],
    packages: PackageIndex,
    environ: Mapping[str, str] = os.environ,
    *,
    describe: DescribeRobot | None = None,
) -> LaunchTree:
    """Return what `roslaunch PATH name:=value …` would start and set (ROS wiki: roslaunch/XML).

    Raise InputError, with the line, if the file itself is wrong or lacks an argument. What an
    include lacks, and what this machine lacks, is left out and stands in the tree's `unresolved`.
    A `<group>`, `<include>` or `<node>` whose condition cannot be known is read as if it counted:
    a node that may start can steer the robot; its nodes are `conditional`. `describe` makes the
    robot description of a xacro file; nothing is executed.
    """
    return read_launches([(path, args)], packages, environ, describe=describe)[0]


def read_launches(
    launches: Iterable[tuple[Path, Mapping[str, str]]],
    packages: PackageIndex,
    environ: Mapping[str, str] = os.environ,
    *,
    describe: DescribeRobot | None = None,
    roots: Iterable[Path] | None = None,
) -> tuple[LaunchTree, ...]:
    """Return what several runs of roslaunch start, one after the other with one master.

    All trees have the parameters as they are in the end: later launches override, delete and
    clear. With `roots`, files outside of these folders are not read. Raise InputError as
    `read_launch` does.
    """
    allowed = None if roots is None else tuple(root.resolve() for root in roots)
    server, documents, trees = ParameterServer(), LaunchFileCache(allowed), []
    for path, args in launches:
        state = LoadState(
            packages={**_TOOL_PACKAGES, **packages},
            environ=environ,
            describe=describe,
            documents=documents,
        )
        trees.append(_read(path, args, state))
        state.parameters.apply(server)
    parameters = server.parameters()
    return tuple(replace(tree, parameters=parameters) for tree in trees)


def _read(path: Path, args: Mapping[str, str], state: LoadState) -> LaunchTree:
    document = state.documents.launch(str(path.absolute()))
    reader = LaunchFileReader(document=document, state=state)
    try:
        reader.read(root_context(args, state.environ.get("ROS_NAMESPACE", "")))
    except MissingArgumentError as error:
        raise _missing_arguments_error(reader.document, args, error.name) from None
    except RecursionError:
        raise InputError("is nested too deep", path=str(path)) from None
    tree = LaunchTree(
        root=reader.result(),
        unresolved=tuple(state.unresolved.unresolved),
        declared=frozenset(state.declared_arguments),
        remaps_behind_all=tuple(state.remaps_behind_all),
        wiring=tuple(state.parameters.overridden.values()),
    )
    return replace(tree, unresolved=tree.unresolved + _duplicate_names(tree))


def _missing_arguments_error(
    document: LaunchDocument, args: Mapping[str, str], used_argument: str
) -> InputError:
    """Return the error that lists every argument which the launch file requires and lacks."""
    declared = list(document.launch.iterchildren("arg"))
    required = [tag for tag in declared if tag.get("value") is None and tag.get("default") is None]
    names = [str(tag.get("name")) for tag in required if tag.get("name") not in args]
    missing = list(dict.fromkeys((*names, used_argument)))
    lines = (line_of(tag) for tag in declared if tag.get("name") == missing[0])
    return InputError(
        f"needs a value for {', '.join(missing)}",
        path=document.path,
        line=next(lines, 0),
        help="give " + " ".join(f"{name}:=…" for name in missing),
    )


def _duplicate_names(tree: LaunchTree) -> tuple[UnresolvedItem, ...]:
    """Return the names that two nodes have; anonymous ones only look alike."""
    sure = (node for node in tree.nodes() if not node.anonymous and not node.conditional)
    counts = Counter(node.name for node in sure)
    why = "several nodes have this name; roslaunch refuses the launch"
    return tuple(
        UnresolvedItem(what=f"node {n}", why=why) for n, times in counts.items() if times > 1
    )

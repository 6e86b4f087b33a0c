"""A roslaunch file and all it includes, as a LaunchTree; nothing is executed."""

import os
from collections import Counter
from collections.abc import Mapping
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.launch.document import LaunchDocument, line_of, parse_launch
from rtron.sources.launch.file_reader import FileReader, Reading
from rtron.sources.launch.packages import PackageIndex
from rtron.sources.launch.scope import root_scope
from rtron.sources.launch.unresolvable import MissingArgumentError
from rtron.vocabulary import LaunchTree, Unresolved


def read_launch(
    path: Path,
    args: Mapping[str, str],
    packages: PackageIndex,
    environ: Mapping[str, str] = os.environ,
) -> LaunchTree:
    """Return what `roslaunch PATH name:=value …` would start (ROS wiki: roslaunch/XML).

    Raise InputError, with the line, if the file itself is wrong or lacks an argument. What an
    include lacks, and what this machine lacks, is left out and stands in the tree's `unresolved`.
    """
    reading = Reading(packages=packages, environ=environ)
    reader = FileReader(document=parse_launch(str(path.absolute())), reading=reading)
    try:
        reader.read(root_scope(args, environ.get("ROS_NAMESPACE", "")))
    except MissingArgumentError as error:
        raise _lacks_arguments(reader.document, args, error.name) from None
    except RecursionError:
        raise InputError("is nested too deep", path=str(path)) from None
    tree = LaunchTree(root=reader.result(), unresolved=tuple(reading.notes.unresolved))
    return LaunchTree(root=tree.root, unresolved=tree.unresolved + _doubled(tree))


def _lacks_arguments(document: LaunchDocument, args: Mapping[str, str], used: str) -> InputError:
    """Return the error that lists every argument which the launch file requires and lacks."""
    declared = list(document.launch.iterchildren("arg"))
    required = [tag for tag in declared if tag.get("value") is None and tag.get("default") is None]
    names = [str(tag.get("name")) for tag in required if tag.get("name") not in args]
    missing = list(dict.fromkeys((*names, used)))
    lines = (line_of(tag) for tag in declared if tag.get("name") == missing[0])
    return InputError(
        f"needs a value for {', '.join(missing)}",
        path=document.path,
        line=next(lines, 0),
        help="give " + " ".join(f"{name}:=…" for name in missing),
    )


def _doubled(tree: LaunchTree) -> tuple[Unresolved, ...]:
    """Return the names that two nodes have; anonymous ones only look alike."""
    counted = Counter(node.name for node in tree.nodes() if not node.anonymous)
    why = "several nodes have this name; roslaunch refuses the launch"
    return tuple(Unresolved(what=f"node {n}", why=why) for n, times in counted.items() if times > 1)

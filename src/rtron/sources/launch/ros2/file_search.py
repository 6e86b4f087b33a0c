"""The launch files of ROS 2 below folders, with the arguments that each declares."""

import ast
from collections.abc import Iterable, Iterator, Mapping
from itertools import islice
from pathlib import Path
from typing import TypeAlias

from rtron.errors import InputError
from rtron.sources.bounded_file import read_regular_file
from rtron.sources.code.frontends.python.lowering import MAX_BYTES
from rtron.sources.code.frontends.python.parser import parse
from rtron.sources.code.frontends.python.source_file import decode
from rtron.sources.launch.common.launch_file import (
    LaunchFileInfo,
    find_ros2_launch_files,
    launch_generation,
)
from rtron.sources.launch.common.packages import package_name
from rtron.sources.launch.ros2.limits import MAX_NAMES
from rtron.sources.launch.ros2.xml_yaml import parse_elements
from rtron.sources.static.common.worker import deep_recursion

_DECLARE_ACTIONS = ("DeclareLaunchArgument", "DeclareBooleanLaunchArgument")
_ArgumentDefault: TypeAlias = tuple[str, bool]
"""An argument, and whether it has a default."""
_LoopNames: TypeAlias = Mapping[str, tuple[str, ...]]
"""Variables of loops, and the names that they go through."""


def list_ros2_launch_files(folders: Iterable[Path]) -> Iterator[LaunchFileInfo]:
    """Yield the launch files of ROS 2 below folders, by path; what they include is not read."""
    tops, packages = {folder.absolute() for folder in folders}, dict[Path, str]()
    for path in find_ros2_launch_files(tops):
        if launch_generation(path) > 1:
            yield _launch_file_info(path, _package(path.parent, tops, packages))


def _launch_file_info(path: Path, package: str) -> LaunchFileInfo:
    try:
        with deep_recursion():
            declared = _declared_arguments(path)
    except InputError as error:
        return LaunchFileInfo(path=path, package=package, error=str(error))
    except RecursionError:
        return LaunchFileInfo(path=path, package=package, error=f"{path}: nested too deep")
    optional = {name for name, has_default in declared if has_default}
    names = dict.fromkeys(name for name, _ in declared)
    return LaunchFileInfo(
        path=path,
        package=package,
        required=tuple(name for name in names if name not in optional),
        optional=tuple(name for name in names if name in optional),
    )


def _declared_arguments(path: Path) -> list[_ArgumentDefault]:
    """Return the arguments of a file; those of a hostile one would fill the memory."""
    arguments = _python_arguments(path) if path.suffix == ".py" else _element_arguments(path)
    declared = list(islice(arguments, MAX_NAMES))
    if next(arguments, None):
        raise InputError(f"declares over {MAX_NAMES} arguments", path=str(path))
    return declared


def _element_arguments(path: Path) -> Iterator[_ArgumentDefault]:
    for argument in parse_elements(str(path)).children_named("arg"):
        if "value" not in argument.attributes:
            yield argument.plain_text("name"), "default" in argument.attributes


def _python_arguments(path: Path) -> Iterator[_ArgumentDefault]:
    """Yield the arguments whose names are written out, where they are declared or looped over."""
    tree, _ = parse(decode(read_regular_file(path, MAX_BYTES))[0])
    pending: list[tuple[ast.AST, _LoopNames]] = [(tree, {})]
    while pending:
        node, words = pending.pop()
        if isinstance(node, ast.Call) and _name(node.func) in _DECLARE_ACTIONS:
            yield from _call_arguments(node, words)
        looped = dict(_loop_variables(node))
        inner = {**words, **looped} if looped else words
        pending.extend((child, inner) for child in reversed(list(ast.iter_child_nodes(node))))


def _call_arguments(call: ast.Call, words: _LoopNames) -> Iterator[_ArgumentDefault]:
    keywords = {word.arg: word.value for word in call.keywords}
    default = keywords.get("default_value")
    no_default = isinstance(default, ast.Constant) and default.value is None
    for name in _literal_names(keywords.get("name") or next(iter(call.args), None), words):
        yield name, default is not None and not no_default


def _loop_variables(node: ast.AST) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Yield the variables of a loop or a comprehension, with the names that are listed for them."""
    loops = [node] if isinstance(node, ast.For) else getattr(node, "generators", ())
    for loop in loops:
        if isinstance(loop.target, ast.Name):
            items = loop.iter.elts if isinstance(loop.iter, (ast.List, ast.Tuple)) else ()
            yield loop.target.id, tuple(name for item in items for name in _literal_names(item, {}))


def _literal_names(name: ast.expr | None, words: _LoopNames) -> tuple[str, ...]:
    if isinstance(name, ast.Constant):
        return (str(name.value),)
    return words.get(name.id, ()) if isinstance(name, ast.Name) else ()


def _name(called: ast.expr) -> str:
    return getattr(called, "attr", getattr(called, "id", ""))


def _package(folder: Path, tops: Iterable[Path], known: dict[Path, str]) -> str:
    """Return the package that a folder lies in, empty for none: packages do not nest."""
    if folder not in known:
        outer = "" if folder in tops else _package(folder.parent, tops, known)
        is_package = not outer and (folder / "package.xml").is_file()
        known[folder] = package_name(folder) if is_package else outer
    return known[folder]

"""The launch files of ROS 2 below folders, and the arguments that each declares by itself."""

import ast
from collections.abc import Iterable, Iterator, Mapping
from itertools import islice
from pathlib import Path
from typing import TypeAlias

from rtron.errors import InputError
from rtron.sources.bounded_file import read_found
from rtron.sources.code.frontends.python.lowering import MAX_BYTES
from rtron.sources.code.frontends.python.parser import parse
from rtron.sources.code.frontends.python.source_encoding import decode
from rtron.sources.launch.common.generation import generation_of
from rtron.sources.launch.common.packages import package_name
from rtron.sources.launch.ros1.file_search import ListedLaunch
from rtron.sources.launch.ros2.folder_search import launch_files2
from rtron.sources.launch.ros2.limits import MAX_NAMES
from rtron.sources.launch.ros2.xml_yaml.element import parse_elements
from rtron.sources.static.common.worker import deep_recursion

_DECLARES = "DeclareLaunchArgument"
_Declared: TypeAlias = tuple[str, bool]
"""An argument, and whether it has a default."""
_Words: TypeAlias = Mapping[str, tuple[str, ...]]
"""Variables of loops, and the names that they go through."""


def ros2_launches(folders: Iterable[Path]) -> Iterator[ListedLaunch]:
    """Yield the launch files of ROS 2 below folders, by path; what they include is not read."""
    tops, packages = {folder.absolute() for folder in folders}, dict[Path, str]()
    for path in launch_files2(tops):
        if generation_of(path) > 1:
            yield _listed(path, _package(path.parent, tops, packages))


def _listed(path: Path, package: str) -> ListedLaunch:
    try:
        with deep_recursion():
            declared = _declared_in(path)
    except InputError as error:
        return ListedLaunch(path=path, package=package, fault=str(error))
    except RecursionError:
        return ListedLaunch(path=path, package=package, fault=f"{path}: nested too deep")
    optional = {name for name, has_default in declared if has_default}
    names = dict.fromkeys(name for name, _ in declared)
    return ListedLaunch(
        path=path,
        package=package,
        required=tuple(name for name in names if name not in optional),
        optional=tuple(name for name in names if name in optional),
    )


def _declared_in(path: Path) -> list[_Declared]:
    """Return the arguments of a file; those of a hostile one would fill the memory."""
    found = _of_python(path) if path.suffix == ".py" else _of_elements(path)
    declared = list(islice(found, MAX_NAMES))
    if next(found, None):
        raise InputError(f"declares over {MAX_NAMES} arguments", path=str(path))
    return declared


def _of_elements(path: Path) -> Iterator[_Declared]:
    for argument in parse_elements(str(path)).named("arg"):
        if "value" not in argument.attributes:
            yield argument.plain("name"), "default" in argument.attributes


def _of_python(path: Path) -> Iterator[_Declared]:
    """Yield the arguments whose names are written out, where they are declared or looped over."""
    tree, _ = parse(decode(read_found(path, MAX_BYTES))[0])
    waiting: list[tuple[ast.AST, _Words]] = [(tree, {})]
    while waiting:
        node, words = waiting.pop()
        if isinstance(node, ast.Call) and _name(node.func) == _DECLARES:
            yield from _declared(node, words)
        looped = dict(_looped(node))
        inner = {**words, **looped} if looped else words
        waiting.extend((child, inner) for child in reversed(list(ast.iter_child_nodes(node))))


def _declared(call: ast.Call, words: _Words) -> Iterator[_Declared]:
    given = {word.arg: word.value for word in call.keywords}
    default = given.get("default_value")
    no_default = isinstance(default, ast.Constant) and default.value is None
    for name in _spelled(given.get("name") or next(iter(call.args), None), words):
        yield name, default is not None and not no_default


def _looped(node: ast.AST) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Yield the variables of a loop or a comprehension, with the names that are listed for them."""
    loops = [node] if isinstance(node, ast.For) else getattr(node, "generators", ())
    for loop in loops:
        if isinstance(loop.target, ast.Name):
            items = loop.iter.elts if isinstance(loop.iter, (ast.List, ast.Tuple)) else ()
            yield loop.target.id, tuple(name for item in items for name in _spelled(item, {}))


def _spelled(name: ast.expr | None, words: _Words) -> tuple[str, ...]:
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

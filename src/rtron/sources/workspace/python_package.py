"""Where a package's Python modules lie: what its setup.py says (ROS wiki: catkin, Python)."""

import ast
import configparser
import re
from collections.abc import Iterator, Mapping
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.bounded_file import read_regular_file
from rtron.sources.workspace.package_files import is_regular

MAX_BYTES = 1024 * 1024

_SETUP_CALLS = frozenset({"generate_distutils_setup", "setup", "dict"})


def module_folder(package: Path, name: str) -> Path:
    """Return the folder of a package's modules: setup.py's `package_dir`, or `src`.

    In ROS 2 the modules' folder is called like the package and stands in its root; the folder of
    the package itself may be called otherwise.

    setup.py is parsed, never run.
    """
    if (package / name / "__init__.py").is_file():
        return package / (_package_dir(package / "setup.py") or "")
    return package / (_package_dir(package / "setup.py") or "src")


def module_file(folder: Path, dotted: str) -> Path | None:
    """Return the file of a module below a folder: the package's `__init__.py` first."""
    parts = dotted.split(".")
    if not all(part.isidentifier() for part in parts):
        return None
    path = folder.joinpath(*parts)
    candidates = (path / "__init__.py", path.with_name(f"{parts[-1]}.py"))
    return next(filter(is_regular, candidates), None)


def _nodes(setup: Path) -> Iterator[ast.AST]:
    """Yield the parts of a setup.py; none if it is not there, or no Python."""
    try:
        tree = ast.parse(read_regular_file(setup, MAX_BYTES) if setup.is_file() else b"")
    except (InputError, SyntaxError, ValueError, RecursionError, MemoryError):
        return
    yield from ast.walk(tree)


def _package_dir(setup: Path) -> str | None:
    calls = (node for node in _nodes(setup) if isinstance(node, ast.Call))
    named = (call for call in calls if getattr(call.func, "id", "") in _SETUP_CALLS)
    words = (word for call in named for word in call.keywords if word.arg == "package_dir")
    return next(filter(None, (_root_folder(word.value) for word in words)), None)


def _root_folder(node: ast.expr) -> str | None:
    """Return the folder of the root, or the one around the first package, in a literal dict."""
    if not isinstance(node, ast.Dict):
        return None
    pairs = [
        (key.value, value.value)
        for key, value in zip(node.keys, node.values, strict=True)
        if isinstance(key, ast.Constant) and isinstance(value, ast.Constant)
    ]
    texts = {name: folder for name, folder in pairs if isinstance(folder, str)}
    around = (str(Path(folder).parent) for folder in texts.values())
    return texts.get("") or next(around, None)


_ENTRY = re.compile(r"\s*([\w.-]+)\s*=\s*([\w.]+)\s*:\s*(\w+)")
_SCRIPTS = "console_scripts"


def entry_points(package: Path) -> Mapping[str, tuple[str, str]]:
    """Return each program's module and function, by the program's name."""
    found = (*_setup_py_entries(package / "setup.py"), *_setup_cfg_entries(package / "setup.cfg"))
    matched = (_ENTRY.match(text) for text in found)
    return {match[1]: (match[2], match[3]) for match in matched if match}


def _setup_py_entries(path: Path) -> Iterator[str]:
    for node in _nodes(path):
        if isinstance(node, ast.Dict):
            for key, value in zip(node.keys, node.values, strict=True):
                if isinstance(key, ast.Constant) and key.value == _SCRIPTS:
                    yield from _string_constants(value)


def _string_constants(node: ast.expr) -> Iterator[str]:
    for inner in ast.walk(node):
        if isinstance(inner, ast.Constant) and isinstance(inner.value, str):
            yield inner.value
        elif isinstance(inner, ast.JoinedStr):
            yield "".join(str(v.value) for v in inner.values if isinstance(v, ast.Constant))


def _setup_cfg_entries(path: Path) -> list[str]:
    reader = configparser.ConfigParser(interpolation=None)
    try:
        reader.read_string(read_regular_file(path, MAX_BYTES).decode("utf-8", "replace"))
    except (InputError, configparser.Error):
        return []
    return reader.get("options.entry_points", _SCRIPTS, fallback="").splitlines()

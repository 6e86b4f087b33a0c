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
_MAX_DEPTH = 32


def entry_points(package: Path) -> Mapping[str, tuple[str, str]]:
    """Return each program's module and function, by the program's name."""
    found = (*_setup_py_entries(package / "setup.py"), *_setup_cfg_entries(package / "setup.cfg"))
    matched = (_ENTRY.match(text) for text in found)
    return {match[1]: (match[2], match[3]) for match in matched if match}


def _setup_py_entries(path: Path) -> Iterator[str]:
    nodes = list(_nodes(path))
    variables = dict(pair for node in nodes for pair in _assigned_text(node))
    for node in nodes:
        if isinstance(node, ast.Dict):
            for key, value in zip(node.keys, node.values, strict=True):
                if isinstance(key, ast.Constant) and key.value == _SCRIPTS:
                    yield from (_text(inner, variables) for inner in ast.walk(value))


def _assigned_text(node: ast.AST) -> Iterator[tuple[str, str]]:
    """Yield the variable and the text of an assignment such as `package_name = "robot"`."""
    if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant):
        names = (target.id for target in node.targets if isinstance(target, ast.Name))
        yield from ((name, str(node.value.value)) for name in names)


def _text(node: ast.AST, variables: Mapping[str, str], depth: int = 0) -> str:
    """Return the text of a string, an f-string or a sum of them; what is not known is empty."""
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else ""
    if isinstance(node, ast.Name):
        return variables.get(node.id, "")
    return "".join(_text(part, variables, depth + 1) for part in _parts(node, depth))


def _parts(node: ast.AST, depth: int) -> list[ast.expr]:
    """Return what a text is put together from, as deep as anybody writes it."""
    if depth == _MAX_DEPTH:
        return []
    if isinstance(node, ast.FormattedValue):
        return [node.value]
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        return [node.left, node.right]
    return node.values if isinstance(node, ast.JoinedStr) else []


def _setup_cfg_entries(path: Path) -> list[str]:
    reader = configparser.ConfigParser(interpolation=None)
    try:
        reader.read_string(read_regular_file(path, MAX_BYTES).decode("utf-8", "replace"))
    except (InputError, configparser.Error):
        return []
    return reader.get("options.entry_points", _SCRIPTS, fallback="").splitlines()

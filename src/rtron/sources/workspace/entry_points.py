"""The programs of an ament_python package: the entry points in its setup.py or setup.cfg.

setuptools' "Entry Points": `name = module:function` below `console_scripts`. Nothing is run.
"""

import ast
import configparser
import re
from collections.abc import Iterator, Mapping
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.bounded_file import read_regular_file

MAX_BYTES = 1024 * 1024

_ENTRY = re.compile(r"\s*([\w.-]+)\s*=\s*([\w.]+)\s*:\s*(\w+)")
_SCRIPTS = "console_scripts"


def entry_points(package: Path) -> Mapping[str, tuple[str, str]]:
    """Return each program's module and function, by the program's name."""
    found = (*_setup_py_entries(package / "setup.py"), *_setup_cfg_entries(package / "setup.cfg"))
    matched = (_ENTRY.match(text) for text in found)
    return {match[1]: (match[2], match[3]) for match in matched if match}


def _setup_py_entries(path: Path) -> Iterator[str]:
    try:
        tree = ast.parse(read_regular_file(path, MAX_BYTES) if path.is_file() else b"")
    except (InputError, SyntaxError, ValueError, RecursionError, MemoryError):
        return
    for node in ast.walk(tree):
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

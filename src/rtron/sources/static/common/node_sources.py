"""The files that a node's program is made of: its sources, and what of the workspace they use."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TypeAlias

from rtron.errors import InputError
from rtron.sources.bounded_file import read_regular_file
from rtron.sources.workspace import Workspace
from rtron.vocabulary import Node

MAX_FILE_BYTES = 2**20
MAX_FILES = 60
"""More files of one node are not searched."""
_INCLUDE = re.compile(rb'^[ \t]*#[ \t]*include[ \t]*["<]([\w./+-]+)[">]', re.MULTILINE)
_IMPORT = re.compile(
    rb"^[ \t]*(?:from[ \t]+([\w.]+)[ \t]+import[ \t]+(\([\w,\s]*\)|[\w, \t]*)"
    rb"|import[ \t]+([\w., \t]+))",
    re.MULTILINE,
)
_Imports: TypeAlias = dict[str, frozenset[str]]
"""The modules that a file imports, each with the names that it takes of it."""
_ALL: frozenset[str] = frozenset()
"""No names: a module as a whole is used."""
_HEADERS = (".h", ".hpp", ".hh", ".hxx")
_SOURCES = (".cpp", ".cc", ".cxx", ".c")
CPP = (*_HEADERS, *_SOURCES, ".ino")


def node_sources(node: Node, workspace: Workspace) -> dict[Path, bytes]:
    """Return the content of each file, the program's own first, up to MAX_FILES."""
    program = workspace.executable(node.package, node.executable) or workspace.component(
        node.package, node.executable
    )
    pending = [(path, _ALL) for path in (program.sources if program else ())]
    found: dict[Path, bytes] = {}
    seen = set[tuple[Path, frozenset[str]]]()
    while pending and len(found) < MAX_FILES:
        path, names = pending.pop(0)
        if (path, names) not in seen:
            seen.add((path, names))
            found[path] = found.get(path) or file_content(path)
            pending.extend(_used(path, found[path], workspace, names))
    return found


def _used(
    path: Path, data: bytes, workspace: Workspace, names: frozenset[str]
) -> Iterator[tuple[Path, frozenset[str]]]:
    """Yield the files that a file uses, each with the names that it takes of it.

    Of a package's `__init__.py` that only hands names on, the modules that give `names`.
    """
    if path.suffix in CPP:
        for text in _INCLUDE.findall(data):
            header = workspace.header(text.decode(), path)
            if header is not None:
                yield header, _ALL
                yield from ((each, _ALL) for each in _implementations(header, workspace))
        return
    package, imports = workspace.package_of(path) or "", _imported(data)
    given = _ALL.union(*imports.values())
    is_handing_on = path.name == "__init__.py" and names and names <= given
    for dotted, taken in imports.items():
        module = workspace.python_module(dotted, package, path)
        if module is not None and not (is_handing_on and taken.isdisjoint(names)):
            yield module, taken


def _implementations(header: Path, workspace: Workspace) -> Iterator[Path]:
    """Yield the sources of a header's package that are called like it."""
    package = workspace.package_of(header)
    for suffix in _SOURCES if package else ():
        yield from workspace.files(package or "").files_named(f"{header.stem}{suffix}")


def _imported(data: bytes) -> _Imports:
    """Return the dotted names that may be modules; relative ones as of the file's folder."""
    found: _Imports = {}
    for source, names, modules in _IMPORT.findall(data):
        dotted, taken = source.decode().strip("."), _names(names)
        parts = (f"{dotted}.{name}".lstrip(".") for name in taken)
        found |= dict.fromkeys((*_names(modules), *parts), _ALL)
        if dotted:
            found[dotted] = found.get(dotted, _ALL).union(taken)
    return found


def _names(written: bytes) -> list[str]:
    """Return what stands between commas, without the name that it is given."""
    words = written.decode().strip("()").split(",")
    return [word.split()[0] for word in words if word.strip()]


def file_content(path: Path) -> bytes:
    """Return a file's content; nothing of one that cannot be read: the scan has a note on it."""
    try:
        return read_regular_file(path, MAX_FILE_BYTES)
    except InputError:
        return b""

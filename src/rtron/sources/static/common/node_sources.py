"""The files that a node's program is made of: its sources, and what of the workspace they use."""

import re
from collections.abc import Iterator
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.bounded_file import read_regular_file
from rtron.sources.workspace import Workspace
from rtron.vocabulary import Node

MAX_FILE_BYTES = 2**20
MAX_FILES = 60
"""More files of one node are not searched."""
_INCLUDE = re.compile(rb'^[ \t]*#[ \t]*include[ \t]*["<]([\w./+-]+)[">]', re.MULTILINE)
_IMPORT = re.compile(
    rb"^[ \t]*(?:from[ \t]+([\w.]+)[ \t]+import[ \t]+([\w, \t]*)|import[ \t]+([\w., \t]+))",
    re.MULTILINE,
)
_HEADERS = (".h", ".hpp", ".hh", ".hxx")
_SOURCES = (".cpp", ".cc", ".cxx", ".c")
CPP = (*_HEADERS, *_SOURCES)


def node_sources(node: Node, workspace: Workspace) -> dict[Path, bytes]:
    """Return the content of each file, the program's own first, up to MAX_FILES."""
    program = workspace.executable(node.package, node.executable) or workspace.component(
        node.package, node.executable
    )
    pending = list(program.sources) if program else []
    found: dict[Path, bytes] = {}
    while pending and len(found) < MAX_FILES:
        path = pending.pop(0)
        if path not in found:
            found[path] = file_content(path)
            pending.extend(_used(path, found[path], workspace))
    return found


def _used(path: Path, data: bytes, workspace: Workspace) -> Iterator[Path]:
    if path.suffix in CPP:
        for text in _INCLUDE.findall(data):
            header = workspace.header(text.decode(), path)
            if header is not None:
                yield header
                yield from _implementations(header, workspace)
        return
    package = workspace.package_of(path) or ""
    for dotted in _imported(data):
        module = workspace.python_module(dotted, package, path)
        if module is not None:
            yield module


def _implementations(header: Path, workspace: Workspace) -> Iterator[Path]:
    """Yield the sources of a header's package that are called like it."""
    package = workspace.package_of(header)
    for suffix in _SOURCES if package else ():
        yield from workspace.files(package or "").files_named(f"{header.stem}{suffix}")


def _imported(data: bytes) -> Iterator[str]:
    """Yield the dotted names that may be modules; relative ones as of the file's folder."""
    for source, names, modules in _IMPORT.findall(data):
        dotted = source.decode().strip(".")
        yield from filter(None, [dotted, *_names(modules)])
        yield from (f"{dotted}.{name}".lstrip(".") for name in _names(names))


def _names(written: bytes) -> Iterator[str]:
    """Yield what stands between commas, without the name that it is given."""
    for word in written.decode().split(","):
        if word.strip():
            yield word.split()[0]


def file_content(path: Path) -> bytes:
    """Return a file's content; nothing of one that cannot be read: the scan has a note on it."""
    try:
        return read_regular_file(path, MAX_FILE_BYTES)
    except InputError:
        return b""

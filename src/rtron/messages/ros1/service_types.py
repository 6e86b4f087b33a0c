"""The service types of ROS 1 that are installed here, and their MD5 sums (ROS wiki: srv).

Type names come from strangers: only a name of the right form becomes a path.
"""

import hashlib
import os
import re
from collections.abc import Iterator, Mapping
from pathlib import Path

from rtron.errors import SourceError
from rtron.messages.common.definition import Definition
from rtron.messages.common.definition_parser import MAX_TEXT

_TYPE = re.compile(r"([A-Za-z]\w{0,127})/([A-Za-z]\w{0,127})", re.ASCII)
_DEBIAN = "/usr/share"
"""Where Debian's packages of ROS 1 have their definitions."""


def find_interface_text(
    type: str, kind: str = "srv", environ: Mapping[str, str] = os.environ
) -> str:
    """Return the text of a type; SourceError if it is not installed or cannot be read.

    `kind` is the folder that it is in, and the ending of its file: srv or action.
    """
    parts = _TYPE.fullmatch(type)
    if parts is None:
        raise SourceError(f"{type[:80]!r} is not a type", help="it is pkg/Name")
    package, name = parts.groups()
    for folder in _package_folders(package, environ):
        text = _read(folder / kind / f"{name}.{kind}")
        if text is not None:
            return text
    help = f"install the package {package}, or add its folder to ROS_PACKAGE_PATH"
    raise SourceError(f"the {kind} type {type} is not installed here", help=help)


def service_md5sum(request: Definition, response: Definition) -> str:
    """Return the MD5 sum of a service type, which client and server compare (genmsg)."""
    text = request.md5_text + response.md5_text
    return hashlib.md5(text.encode(), usedforsecurity=False).hexdigest()


def _package_folders(package: str, environ: Mapping[str, str]) -> Iterator[Path]:
    """Yield where a package may be: sources, then installed ones, then Debian's."""
    for root in _paths(environ, "ROS_PACKAGE_PATH"):
        yield root if root.name == package else root / package
    for prefix in _paths(environ, "CMAKE_PREFIX_PATH"):
        yield prefix / "share" / package
    yield Path(_DEBIAN, package)


def _paths(environ: Mapping[str, str], variable: str) -> Iterator[Path]:
    return (Path(each) for each in environ.get(variable, "").split(os.pathsep) if each)


def _read(path: Path) -> str | None:
    """Return a definition's text, None if there is none; SourceError if it is too long."""
    try:
        with path.open("rb") as file:
            data = file.read(MAX_TEXT + 1)
    except OSError:
        return None
    if len(data) > MAX_TEXT:
        raise SourceError(f"{path} is longer than {MAX_TEXT} bytes")
    return data.decode(errors="replace")

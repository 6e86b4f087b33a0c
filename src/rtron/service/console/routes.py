"""The console in the browser: one static page that speaks to the HTTP API, and to nothing else.

All files are read once and served from memory by their exact names. Their path has a digest of all
of them, so browsers may keep them for ever and never mix two versions. They work under a policy of
`default-src 'self'`: no inline script or style, no eval.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from gzip import compress
from hashlib import sha256
from importlib.resources import files
from itertools import chain
from pathlib import Path

from fastapi import APIRouter, HTTPException, Request
from fastapi.responses import Response

_MEDIA_TYPES = {
    "js": "text/javascript; charset=utf-8",
    "css": "text/css; charset=utf-8",
    "html": "text/html; charset=utf-8",
    "svg": "image/svg+xml",
    "txt": "text/plain; charset=utf-8",
}
_GRAPH = Path(str(files("rtron.reports"))) / "page" / "graph"
"""The graph and its layout library, which the HTML report has too."""
_IMMUTABLE = "public, max-age=31536000, immutable"

router = APIRouter(include_in_schema=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class StaticFile:
    """A file of the console: its bytes, the same packed by gzip, and its media type."""

    content: bytes
    gzipped: bytes
    media_type: str


@router.get("/")
def page(request: Request) -> Response:
    """Return the page, which names all files of this version."""
    return _file_response(request, _index_page(), "no-cache")


@router.get("/console/{version}/{name:path}")
def static_file(request: Request, version: str, name: str) -> Response:
    """Return a file of this version."""
    file = static_files().get(name) if version == digest() else None
    if file is None:
        raise HTTPException(404, "no such file")
    return _file_response(request, file, _IMMUTABLE)


@cache
def static_files() -> dict[str, StaticFile]:
    """Return all files by their names, as modules import them."""
    return dict(chain(_below(Path(__file__).with_name("static")), _below(_GRAPH, "graph/")))


@cache
def digest() -> str:
    """Return what names this version of all files."""
    parts = (f"{name}\0".encode() + each.content for name, each in sorted(static_files().items()))
    return sha256(b"\0".join(parts)).hexdigest()[:16]


def _below(root: Path, prefix: str = "") -> Iterator[tuple[str, StaticFile]]:
    for path in sorted(root.rglob("*")):
        if _extension(path.name) in _MEDIA_TYPES:
            yield (
                prefix + path.relative_to(root).as_posix(),
                _static_file(path.name, path.read_bytes()),
            )


def _static_file(name: str, data: bytes) -> StaticFile:
    return StaticFile(
        content=data, gzipped=compress(data, mtime=0), media_type=_MEDIA_TYPES[_extension(name)]
    )


def _extension(name: str) -> str:
    return name.rpartition(".")[2]


@cache
def _index_page() -> StaticFile:
    """Return the page, with links by which the browser gets all modules at once."""
    modules = sorted(
        name for name in static_files() if name.endswith(".js") and "min.js" not in name
    )
    links = "\n".join(f'<link rel="modulepreload" href="$base/{name}">' for name in modules)
    text = static_files()["index.html"].content.decode().replace("$modules", links)
    return _static_file("index.html", text.replace("$base", f"/console/{digest()}").encode())


def _file_response(request: Request, file: StaticFile, cache_control: str) -> Response:
    headers = {"Cache-Control": cache_control, "Vary": "Accept-Encoding"}
    if "gzip" in request.headers.get("accept-encoding", ""):
        headers["Content-Encoding"] = "gzip"
        return Response(file.gzipped, media_type=file.media_type, headers=headers)
    return Response(file.content, media_type=file.media_type, headers=headers)

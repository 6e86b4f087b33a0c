"""The console in the browser: one static page that speaks to the HTTP API, and to nothing else.

All files are read once and served from memory by their exact names. Their path has a digest of all
of them, so browsers may keep them for ever and never mix two versions. They work under a policy of
`default-src 'self'`: no inline script or style, no eval.

On a slow line each request costs more than its bytes: the modules are two scripts, what the first
page needs and the rest, the style sheets are one.

A module is a function that runs once and returns what it exports; a module's script runs the
modules that it imports first. So much of the language of modules is known as the console uses:
`import { a, b as c } from "./x.js";` on a line of its own, and exported functions, classes and
constants.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from gzip import compress
from hashlib import sha256
from importlib.resources import files
from pathlib import Path
from posixpath import dirname, join, normpath

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
_STYLES = ("vendor/uplot.min.css", "base.css", "parts.css", "views/graph.css")
_PRELOAD = '<link rel="preload" as="fetch" crossorigin href="{}">'
_ME, _ROBOTS = "/api/v1/me", "/api/v1/robots?states=false&amp;limit=1000"
_COOKIE = "rtron"
"""The end of the name of the session's cookie."""
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
    """Return the page, which names the files of this version."""
    page = _index_page(is_known=any(name.endswith(_COOKIE) for name in request.cookies))
    return _file_response(request, page, "no-cache")


@router.get("/console/{version}/{name:path}")
def static_file(request: Request, version: str, name: str) -> Response:
    """Return a file of this version."""
    file = static_files().get(name) if version == digest() else None
    if file is None:
        raise HTTPException(404, "no such file")
    return _file_response(request, file, _IMMUTABLE)


@cache
def static_files() -> dict[str, StaticFile]:
    """Return all files by their names."""
    sources = source_files()
    modules = {name: data.decode() for name, data in sources.items() if _is_module(name)}
    first = bundle(modules, "main.js", {})
    contents = {name: data for name, data in sources.items() if not _is_bundled(name)}
    contents["main.js"] = f"const modules = {{}};\n{script(first)}".encode()
    contents["later.js"] = script(bundle(modules, "later.js", first)).encode()
    contents["console.css"] = b"\n".join(sources[name] for name in _STYLES)
    return {name: _static_file(name, data) for name, data in contents.items()}


@cache
def source_files() -> Mapping[str, bytes]:
    """Return the files that the console is made of, by the names that modules import."""
    return {**dict(_below(Path(__file__).with_name("static"))), **dict(_below(_GRAPH, "graph/"))}


def _is_module(name: str) -> bool:
    return name.endswith(".js") and not name.endswith(".min.js") and name != "theme.js"


def _is_bundled(name: str) -> bool:
    return _is_module(name) or name.endswith(".css")


@cache
def digest() -> str:
    """Return what names this version of all files."""
    parts = (f"{name}\0".encode() + each.content for name, each in sorted(static_files().items()))
    return sha256(b"\0".join(parts)).hexdigest()[:16]


def _below(root: Path, prefix: str = "") -> Iterator[tuple[str, bytes]]:
    for path in sorted(root.rglob("*")):
        if _extension(path.name) in _MEDIA_TYPES:
            yield prefix + path.relative_to(root).as_posix(), path.read_bytes()


def _static_file(name: str, data: bytes) -> StaticFile:
    return StaticFile(
        content=data, gzipped=compress(data, mtime=0), media_type=_MEDIA_TYPES[_extension(name)]
    )


def _extension(name: str) -> str:
    return name.rpartition(".")[2]


@cache
def _index_page(*, is_known: bool) -> StaticFile:
    """Return the page with links to the data that it shows first, to who seems to be logged in.

    A browser that another site has sent here does not say that it has a session, so who it is is
    asked in any case.
    """
    paths = (_ME, _ROBOTS) if is_known else (_ME,)
    links = "\n".join(map(_PRELOAD.format, paths))
    text = static_files()["index.html"].content.decode().replace("$preloads", links)
    return _static_file("index.html", text.replace("$base", f"/console/{digest()}").encode())


def _file_response(request: Request, file: StaticFile, cache_control: str) -> Response:
    headers = {"Cache-Control": cache_control, "Vary": "Accept-Encoding"}
    if "gzip" in request.headers.get("accept-encoding", ""):
        headers["Content-Encoding"] = "gzip"
        return Response(file.gzipped, media_type=file.media_type, headers=headers)
    return Response(file.content, media_type=file.media_type, headers=headers)


_IMPORT = re.compile(
    r'^(?P<way>import|export) \{(?P<names>[^}]*)\} from "(?P<path>\.[^"]+)";$', re.MULTILINE
)
_DECLARATION = re.compile(
    r"^export (?=(?:async )?(?:function|class|const) (?P<name>\w+))", re.MULTILINE
)
_LIST = re.compile(r"export\{(?P<names>[^}]*)\};?\s*$")
_LEFT_OVER = re.compile(r"^\s*(?:import|export)\b.*", re.MULTILINE)
_INDENT = re.compile(r"^[ \t]+|^//.*\n", re.MULTILINE)


def bundle(modules: Mapping[str, str], entry: str, loaded: Mapping[str, str]) -> dict[str, str]:
    """Return the modules that `entry` needs and that are not `loaded`, by name, in their order.

    ValueError for a module that cannot be bundled.
    """
    ordered: dict[str, str] = {}

    def add(name: str, importers: tuple[str, ...]) -> None:
        if name in importers:
            raise ValueError(f"modules import each other: {' '.join([*importers, name])}")
        if name in ordered or name in loaded:
            return
        for imported, names in _imports(name, modules[name]):
            add(imported, (*importers, name))
            if missing := names - _exports(modules[imported]).keys():
                raise ValueError(f"{name}: {imported} does not export {', '.join(sorted(missing))}")
        ordered[name] = _function(name, modules[name])

    add(entry, ())
    return ordered


def script(functions: Mapping[str, str]) -> str:
    """Return one script of bundled modules."""
    return "\n".join(functions.values())


def _imports(name: str, text: str) -> Iterator[tuple[str, set[str]]]:
    """Yield the modules that a module imports, with the names that it takes of each."""
    for found in _IMPORT.finditer(text):
        names = {_pair(each)[0] for each in found["names"].split(",")}
        yield _resolve(name, found["path"]), names


def _exports(text: str) -> dict[str, str]:
    """Return what a module exports: each name with the one that it has within."""
    exports = {found["name"]: found["name"] for found in _DECLARATION.finditer(text)}
    for found in _IMPORT.finditer(text):
        if found["way"] == "export":
            exports |= {inner: inner for _, inner in map(_pair, found["names"].split(","))}
    listed = _LIST.search(text)
    if listed:
        exports |= {outer: inner for inner, outer in map(_pair, listed["names"].split(","))}
    return exports


def _resolve(name: str, path: str) -> str:
    return normpath(join(dirname(name), path))


def _function(name: str, text: str) -> str:
    exports = ", ".join(f"{outer}: {inner}" for outer, inner in _exports(text).items())
    body = _IMPORT.sub(lambda found: _destructuring(name, found), text)
    body = _LIST.sub("", _DECLARATION.sub("", body))
    if left_over := _LEFT_OVER.search(body):
        raise ValueError(f"{name}: {left_over[0][:80]}")
    return (
        f'modules["{name}"] = (() => {{ "use strict";\n{_INDENT.sub("", body)}\n'
        f"return {{ {exports} }}; }})();"
    )


def _destructuring(name: str, found: re.Match[str]) -> str:
    names = ", ".join(": ".join(_pair(each)) for each in found["names"].split(","))
    return f'const {{ {names} }} = modules["{_resolve(name, found["path"])}"];'


def _pair(name: str) -> tuple[str, str]:
    """Return the names of `a as b`, or twice the name."""
    outer, _, inner = name.strip().partition(" as ")
    return outer, inner or outer

"""The console's modules in as few scripts as a slow line needs: no build, no tool.

A module is a function that runs once and returns what it exports; a module's script runs the
modules that it imports first. So much of the language of modules is known as the console uses:
`import { a, b as c } from "./x.js";` on a line of its own, and exported functions, classes and
constants.
"""

import re
from collections.abc import Iterator, Mapping
from posixpath import dirname, join, normpath

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

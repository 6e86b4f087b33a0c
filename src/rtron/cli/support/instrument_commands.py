"""The commands that put a plan between the nodes of an app."""

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from shlex import quote
from types import MappingProxyType
from typing import NamedTuple
from xml.sax.saxutils import quoteattr

_SUFFIXES = {1: ("",), 2: (".py", ".xml", ".yaml", ".yml")}
"""The end of a launch file's name behind `.launch`, by ROS; the usual one first."""
_ALL = {1: "all.launch", 2: "all.launch.yaml"}
"""The launch file that includes those of an app, by ROS."""


class Launch(NamedTuple):
    """A launch file and its arguments."""

    path: Path
    arguments: Mapping[str, str] = MappingProxyType({})


def instrument_commands(
    launches: Sequence[Launch], plan: Path, ros: int, options: Sequence[str] = ()
) -> Iterator[str]:
    """Yield the commands that write the guarded launch of an app for a plan.

    An app has one guard: of several launch files, the first command writes one that includes them.
    `options` say where the app's packages are, and its environment.
    """
    usual, *others = _SUFFIXES[ros]
    shown, arguments = launches[0] if launches else Launch(Path(f"APP.launch{usual}"))
    if len(launches) > 1:
        including = _all_in_xml(launches) if ros == 1 else _all_in_yaml(launches)
        yield f"printf %s {quote(including)} > {_ALL[ros]}"
        shown, arguments = Launch(Path(_ALL[ros]))
    suffix = next((end for end in others if shown.name.endswith(end)), usual)
    given = [f"{name}:={value}" for name, value in arguments.items()]
    words = [_path_from_here(shown), *given, *options, "--plan", str(plan)]
    yield f"rtron instrument {' '.join(map(quote, words))} -o guarded.launch{suffix}"


def _all_in_xml(launches: Sequence[Launch]) -> str:
    includes = (
        f"<include file={quoteattr(str(path.absolute()))}>{_xml_arguments(given)}</include>"
        for path, given in launches
    )
    return f"<launch>{''.join(includes)}</launch>"


def _xml_arguments(given: Mapping[str, str]) -> str:
    pairs = (map(quoteattr, pair) for pair in given.items())
    return "".join(f"<arg name={name} value={value}/>" for name, value in pairs)


def _all_in_yaml(launches: Sequence[Launch]) -> str:
    """Return a launch file whose groups keep the arguments of each file from the next."""
    groups = [{"group": [{"include": _yaml_include(*each)}]} for each in launches]
    return json.dumps({"launch": groups})


def _yaml_include(path: Path, given: Mapping[str, str]) -> dict[str, object]:
    """Return what a launch file is included with; an empty list is an error in ROS 2."""
    arguments = [{"name": name, "value": value} for name, value in given.items()]
    return {"file": str(path.absolute())} | ({"arg": arguments} if arguments else {})


def _path_from_here(path: Path) -> str:
    here = Path.cwd()
    return str(path.relative_to(here)) if path.is_relative_to(here) else str(path)

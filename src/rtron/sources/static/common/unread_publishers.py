"""Topics that are subscribed and that nobody is known to publish, though code may do it."""

import re
from collections.abc import Collection, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

from rtron.sources.static.common.node_sources import file_content
from rtron.sources.workspace import Workspace
from rtron.vocabulary import Evidence, InteractionGraph, WiringFact, WiringFactKind

_Line: TypeAlias = tuple[str, int]
MAX_FILES = 5_000
"""More of an app's own code is not searched: what a search finds only makes findings milder."""
_CODE = (".py", ".cpp", ".cc", ".cxx", ".h", ".hpp")
_TEST_FOLDERS = frozenset({"test", "tests"})
_MAIN = re.compile(rb"__main__|\bmain\s*\(\s*(?:void|int\b|\))")
_NEAR_LINES = 2
_CALL_LINES = 4
"""How many lines a call that declares an endpoint may take: its name is in one of them."""
_SENDS = re.compile(rb"publish|advertis", re.IGNORECASE)
_MIN_LENGTH = 3
"""Shorter names stand everywhere."""


def with_unread_publishers(graph: InteractionGraph, workspace: Workspace) -> InteractionGraph:
    """Return a graph with a fact for each topic without a publisher that code seems to publish.

    The code is that of the packages whose nodes are in the graph. Its text is searched for the
    topic's last name beside a word such as `publish`, on lines that no endpoint was read from.
    """
    topics = _topics_by_last_name(graph)
    read = {
        (each.file, each.line + offset)
        for end in graph.endpoints
        for each in end.evidence
        for offset in range(_CALL_LINES)
    }
    places: dict[str, Evidence] = {}
    paths, started = _code_files(graph, workspace), _started_programs(graph, workspace)
    for name, place in _mentions(topics, paths, started, read) if topics else ():
        places.setdefault(name, place)
    kind = WiringFactKind.UNREAD_PUBLISHER
    facts = (
        WiringFact(kind=kind, subject=topic, evidence=(place,))
        for name, place in sorted(places.items())
        for topic in topics[name]
    )
    return replace(graph, wiring=(*graph.wiring, *facts))


def _topics_by_last_name(graph: InteractionGraph) -> dict[str, list[str]]:
    """Return the topics that only have subscribers, by the last part of their names."""
    found: dict[str, list[str]] = {}
    subscribed = {end.topic for end in graph.endpoints if not end.implicit}
    for topic in sorted(subscribed):
        name = topic.rpartition("/")[2]
        if not graph.publishers(topic) and "{" not in name and len(name) >= _MIN_LENGTH:
            found.setdefault(name, []).append(topic)
    return found


def _code_files(graph: InteractionGraph, workspace: Workspace) -> Iterator[Path]:
    """Yield the code of the packages that nodes come from, up to MAX_FILES files; no tests."""
    packages = sorted({node.package for node in graph.nodes} & workspace.packages.keys())
    count = 0
    for package in packages:
        files = workspace.files(package)
        for name in files.names:
            path = files.folder / name
            is_code = name.endswith(_CODE) and not _TEST_FOLDERS.intersection(name.split("/"))
            if is_code and count < MAX_FILES and files.is_file(path):
                count += 1
                yield path


def _started_programs(graph: InteractionGraph, workspace: Workspace) -> set[Path]:
    """Return the files of the programs that the launch starts."""
    started = {(node.package, node.executable) for node in graph.nodes}
    programs = (workspace.executable(package, name) for package, name in sorted(started))
    return {source for program in programs if program for source in program.sources}


def _mentions(
    names: Iterable[str], paths: Iterable[Path], started: set[Path], read: Collection[_Line]
) -> Iterator[tuple[str, Evidence]]:
    """Yield names with the places where a text that ends with them stands beside a publisher.

    What is a program of its own, and not started, publishes nothing in this app.
    """
    words = b"|".join(re.escape(name.encode(errors="surrogatepass")) for name in names)
    quoted = re.compile(rb"[\"'/](%s)[\"']" % words)
    for path in paths:
        data = file_content(path)
        if quoted.search(data) and (path in started or not _MAIN.search(data)):
            lines = (
                b"" if (str(path), number) in read else line
                for number, line in enumerate(data.split(b"\n"), 1)
            )
            yield from _mentions_in(path, list(lines), quoted)


def _mentions_in(
    path: Path, lines: list[bytes], quoted: re.Pattern[bytes]
) -> Iterator[tuple[str, Evidence]]:
    sends = [bool(_SENDS.search(line)) for line in lines]
    for number, line in enumerate(lines):
        if any(sends[max(0, number - _NEAR_LINES) : number + _NEAR_LINES + 1]):
            for name in set(quoted.findall(line)):
                place = Evidence(file=str(path), line=number + 1)
                yield name.decode(errors="surrogatepass"), place

"""Places whose text is a call that joins nodes in ROS 2, found by words, not by RTron's readers.

C++ calls write out the type (`create_publisher<T>(`), which tells them from a wrapper's definition.
Tests and rviz's panels are no node sources.
"""

import re
from collections import defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TypeAlias

Site: TypeAlias = tuple[str, int]
"""A file and a line."""

KINDS = {
    "publisher": "create_publisher",
    "subscription": "create_subscription",
    "service": "create_service",
    "action server": "create_action_server",
}
_CPP = frozenset({".cpp", ".hpp", ".cc", ".h", ".hh", ".cxx"})
_CPP_COMMENT = re.compile(r'"(?:\\.|[^"\\\n])*"|(?P<comment>/\*.*?\*/|//[^\n]*)', re.DOTALL)
_PYTHON_COMMENT = re.compile(r"(?P<comment>#[^\n]*)")
_TESTS = re.compile(r"(^|[_/])(tests?|testing|system_tests|benchmarks?|rviz_plugins)(/|$)")


def call_sites(folder: Path) -> Mapping[str, frozenset[Site]]:
    """Return the sites below a folder, by kind."""
    found: dict[str, set[Site]] = defaultdict(set)
    for path in sorted(folder.rglob("*")):
        location = str(path.relative_to(folder).parent)
        if (path.suffix in _CPP or path.suffix == ".py") and not _TESTS.search(location):
            for kind, line in _sites(path):
                found[kind].add((str(path), line))
    return {kind: frozenset(found[kind]) for kind in KINDS}


def _sites(path: Path) -> Iterator[tuple[str, int]]:
    python = path.suffix == ".py"
    text = path.read_bytes().decode("utf-8", "replace")
    code = (_PYTHON_COMMENT if python else _CPP_COMMENT).sub(_blank, text)
    for kind, word in KINDS.items():
        form = rf"\.{word}\(" if python else rf"\b{word}\s*<[^;()]*>\s*\("
        for match in re.finditer(form, code):
            start = match.start() + (match.group()[0] == ".")
            yield kind, code.count("\n", 0, start) + 1


def _blank(found: re.Match[str]) -> str:
    return "\n" * found.group().count("\n") if found["comment"] else found.group()

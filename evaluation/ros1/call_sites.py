"""Places whose text looks like a call that declares something: a check on what is never reached.

A call that the interpreter does not come to is neither resolved nor unresolved; without this check
a tool that reaches nothing would look best.
"""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

from rtron.sources.declaration import Declaration, NodeInterface

Call: TypeAlias = tuple[str, str, int]
"""What is declared, a file and a line."""

_HOLE = re.compile(r"\{([^{}]*)\}")
_PARAMETER = ("~", "/")


@dataclass(frozen=True, slots=True)
class CallCount:
    """The calls of one program, and which of them are unresolved."""

    calls: frozenset[Call]
    unresolved: frozenset[Call]


def count_calls(interface: NodeInterface) -> CallCount:
    """Return the calls of a node's interface."""
    explicit = [found for found in interface.declarations if not found.implicit]
    unknown = (found for found in explicit if not is_explained(found.name))
    return CallCount(frozenset(_calls(explicit)), frozenset(_calls(unknown)))


def is_explained(name: str) -> bool:
    """Tell whether every hole of a name (`/{~prefix}/scan`) is a parameter."""
    return all(hole.startswith(_PARAMETER) for hole in _HOLE.findall(name))


def _calls(declarations: Iterable[Declaration]) -> Iterator[Call]:
    for found in declarations:
        location = found.evidence[0]
        yield found.kind.value, location.file, location.line


CallSite: TypeAlias = tuple[str, int]
"""A file and a line."""

NEAR = 3
"""Lines between where a call begins and where it is said to be."""
_CPP = re.compile(
    r"(?:\.|->)\s*(?:advertise|subscribe|advertiseService|serviceClient)\s*(?:<[^;()]*>)?\s*\("
)
_PYTHON = re.compile(r"rospy\.(?:Publisher|Subscriber|Service|ServiceProxy)\(")
_CPP_COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
_PYTHON_COMMENT = re.compile(r"#[^\n]*")


def call_sites(paths: Iterable[Path]) -> frozenset[CallSite]:
    """Return the lines of source files that look like calls, outside comments."""
    return frozenset(site for path in paths for site in _sites(path))


def unreached(sites: Iterable[CallSite], calls: Iterable[Call]) -> list[CallSite]:
    """Return the sites near which no call was counted."""
    reached = {(file, line) for _, file, line in calls}
    near = range(-NEAR, NEAR + 1)
    return sorted(s for s in sites if not any((s[0], s[1] + d) in reached for d in near))


def _sites(path: Path) -> Iterator[CallSite]:
    python = path.suffix not in {".cpp", ".cc", ".cxx", ".c", ".cu"}
    text = path.read_bytes().decode("utf-8", "replace")
    code = (_PYTHON_COMMENT if python else _CPP_COMMENT).sub(_blank, text)
    for found in (_PYTHON if python else _CPP).finditer(code):
        yield str(path), code.count("\n", 0, found.start()) + 1


def _blank(comment: re.Match[str]) -> str:
    return "\n" * comment[0].count("\n")

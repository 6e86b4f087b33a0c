"""Comments that ignore a finding where it was read: `rtron: ignore[rule] reason`.

They stand in the line of the evidence or in the one before, in the comments of any language:

    pub = rospy.Publisher('/cmd_vel', Twist)  # rtron: ignore[several_publishers] a test rig
"""

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator
from pathlib import Path

from rtron.errors import InputError
from rtron.sources.bounded_file import read_regular_file
from rtron.vocabulary import Evidence, Ignore

MAX_BYTES = 2**22
_COMMENT = re.compile(r"rtron:\s{0,4}ignore\[(\w{1,40})\]\s{0,4}([^\n]{0,200})")
_CLOSINGS = ("-->", "*/")


def comment_ignores(evidence: Iterable[Evidence], root: Path) -> Iterator[Ignore]:
    """Yield the comments beside what was read in files below `root`; a file that is gone has none.

    A comment without a reason ignores nothing.
    """
    lines: dict[str, set[int]] = defaultdict(set)
    for each in evidence:
        lines[each.file].update((each.line - 1, each.line))
    for name, numbers in lines.items():
        path = root / name
        if path.is_relative_to(root) and ".." not in path.parts:
            yield from _in_file(path, name, numbers)


def _in_file(path: Path, name: str, numbers: set[int]) -> Iterator[Ignore]:
    try:
        text = read_regular_file(path, MAX_BYTES).decode("utf-8", "replace")
    except InputError:
        return
    for number, line in enumerate(text.split("\n"), 1):
        match = _COMMENT.search(line) if number in numbers else None
        reason = _reason(match[2]) if match else ""
        if match and reason:
            place = Evidence(file=name, line=number)
            yield Ignore(rule=match[1], reason=reason, place=place, is_comment=True)


def _reason(text: str) -> str:
    for end in _CLOSINGS:
        text = text.partition(end)[0]
    return text.strip()

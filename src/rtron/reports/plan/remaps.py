"""The remaps of a plan by node, as text to paste and as JSON."""

from collections.abc import Iterator, Sequence
from itertools import groupby
from operator import itemgetter
from typing import Any

from rich.text import Text

from rtron.reports.text_layout import Report, TextPage, columns, counted, heading, line, paragraph

REMAPS_SCHEMA = "rtron.remaps/1"
PlannedRemap = tuple[str, str, str]
"""A node, the public name, and the private name that takes its place."""
_START = {
    1: "rosrun PACKAGE NODE NAME:=NAME …",
    2: "ros2 run PACKAGE NODE --ros-args -r NAME:=NAME -r …",
}
_ADVICE = (
    "Give each node its remaps where it is started, and start `rtron guard` with the plan. A node "
    "that has a remap to the public name already needs the private name there instead."
)


def remaps_to_json(ros: int, remaps: Sequence[PlannedRemap]) -> dict[str, Any]:
    """Return the JSON document; `arguments` is what to append to a node's command line."""
    return {
        "schema": REMAPS_SCHEMA,
        "ros": ros,
        "nodes": [
            {
                "node": node,
                "remaps": [{"topic": public, "target": private} for _, public, private in group],
                "arguments": _arguments(ros, group),
            }
            for node, group in _by_node(remaps)
        ],
    }


def remaps_text(title: str, ros: int, remaps: Sequence[PlannedRemap]) -> Report:
    """Return a report: the remaps of each node, and where to put them."""
    return Report(lambda page: _lines(title, ros, remaps, page))


def _lines(title: str, ros: int, remaps: Sequence[PlannedRemap], page: TextPage) -> Iterator[Text]:
    nodes = _by_node(remaps)
    count = f"{counted(len(remaps), 'remap')} on {counted(len(nodes), 'node')}"
    yield line((title, "bold"), f"  {count}")
    for node, group in nodes:
        yield from heading(node)
        rows = [(f"{public}:={private}",) for _, public, private in group]
        yield from columns(rows, ("cyan",), indent=2)
    if remaps:
        yield from heading("Next")
        yield line((_START[ros], "bold green"), indent=2)
        yield from paragraph(_ADVICE, page, indent=2)


def _by_node(remaps: Sequence[PlannedRemap]) -> list[tuple[str, list[PlannedRemap]]]:
    return [(node, list(group)) for node, group in groupby(remaps, key=itemgetter(0))]


def _arguments(ros: int, remaps: Sequence[PlannedRemap]) -> list[str]:
    rules = [f"{public}:={private}" for _, public, private in remaps]
    return rules if ros == 1 else ["--ros-args", *(w for rule in rules for w in ("-r", rule))]

"""What instrumenting a launch file gave, as text and as JSON."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from itertools import groupby
from operator import itemgetter
from shlex import quote
from typing import Any

from rich.text import Text

from rtron.reports.plan.problems import Remark, remark_lines, void_lines
from rtron.reports.text_layout import Report, TextPage, columns, counted, heading, line, paragraph


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeRemap:
    """A remap that the guarded launch puts on a node: the name `written` leads to `target`."""

    node: str
    topic: str
    written: str
    target: str


@dataclass(frozen=True, slots=True, kw_only=True)
class UnenforceableNode:
    """A node of the plan that the guarded launch does not close, and why."""

    what: str
    why: str
    accepted: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class InstrumentedLaunch:
    """A guarded launch file: what it changes, and what it does not achieve.

    None is written for a plan that guards nothing; `left_out` says why.
    """

    launch: str = ""
    files: tuple[str, ...] = ()
    remaps: tuple[NodeRemap, ...] = ()
    unenforceable: tuple[UnenforceableNode, ...] = ()
    notes: tuple[str, ...] = ()
    ros: int = 1
    guards_nothing: bool = False
    left_out: tuple[Remark, ...] = ()

    @property
    def is_closed(self) -> bool:
        """Whether nothing is open but what the plan accepts."""
        return all(node.accepted for node in self.unenforceable)


def instrumentation_to_json(launch: InstrumentedLaunch) -> dict[str, Any]:
    """Return the report as a JSON document."""
    return {"schema": "rtron.instrumented/1", **asdict(launch)}


def instrumentation_text(launch: InstrumentedLaunch) -> Report:
    """Return the report: each node's remaps, the nodes that stay open, and how to start the app."""
    return Report(lambda page: _lines(launch, page))


def _lines(launch: InstrumentedLaunch, page: TextPage) -> Iterator[Text]:
    if launch.guards_nothing:
        yield from void_lines(is_void=True)
        yield from heading(f"Left out ({len(launch.left_out)})") if launch.left_out else ()
        yield from remark_lines(launch.left_out, page)
        return
    nodes = len({remap.node for remap in launch.remaps})
    remaps = counted(len(launch.remaps), "remap")
    yield line((launch.launch, "bold"), f"  {remaps} on {counted(nodes, 'node')}")
    yield from _remaps(launch.remaps)
    yield from _unenforceable(
        "Unenforceable", "bold red", launch.unenforceable, page, accepted=False
    )
    yield from _unenforceable("Accepted", "yellow", launch.unenforceable, page, accepted=True)
    if launch.notes:
        yield from heading("Notes")
    for note in launch.notes:
        yield from paragraph(note, page, indent=2)
    yield from _next_step(launch, page)


def _remaps(remaps: Sequence[NodeRemap]) -> Iterator[Text]:
    for node, group in groupby(sorted(remaps, key=_node_of), key=_node_of):
        yield from heading(node)
        rows = [(remap.written, "to", remap.target) for remap in group]
        yield from columns(rows, ("cyan", "dim", ""), indent=2)


def _node_of(remap: NodeRemap) -> str:
    return remap.node


def _unenforceable(
    title: str, style: str, nodes: Sequence[UnenforceableNode], page: TextPage, *, accepted: bool
) -> Iterator[Text]:
    chosen = [node for node in nodes if node.accepted is accepted]
    if chosen:
        yield from heading(f"{title} ({len(chosen)})")
    for node in chosen:
        yield line((node.what, style), indent=2)
        yield from paragraph(node.why, page, indent=4)


def _next_step(launch: InstrumentedLaunch, page: TextPage) -> Iterator[Text]:
    yield from heading("Next")
    if not launch.is_closed:
        advice = "close what is unenforceable, or name it in the plan's accept_unenforceable"
        yield from paragraph(advice, page, indent=2)
    start = "roslaunch" if launch.ros == 1 else "ros2 launch"
    yield line((f"{start} {quote(launch.launch)}", "bold green"), indent=2)


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
    return Report(lambda page: _remap_lines(title, ros, remaps, page))


def _remap_lines(
    title: str, ros: int, remaps: Sequence[PlannedRemap], page: TextPage
) -> Iterator[Text]:
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

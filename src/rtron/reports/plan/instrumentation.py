"""What instrumenting a launch file gave, as text and as JSON."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from itertools import groupby
from shlex import quote
from typing import Any

from rich.text import Text

from rtron.reports.text_layout import Page, Report, columns, counted, heading, line, paragraph


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeRemap:
    """A remap that the guarded launch puts on a node: the name `written` leads to `target`."""

    node: str
    topic: str
    written: str
    target: str


@dataclass(frozen=True, slots=True, kw_only=True)
class OpenEnd:
    """A node of the plan that the guarded launch does not close, and why."""

    what: str
    why: str
    accepted: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Guarded:
    """A guarded launch file: what it changes, and what it does not achieve."""

    launch: str
    files: tuple[str, ...]
    remaps: tuple[NodeRemap, ...]
    unenforceable: tuple[OpenEnd, ...]
    notes: tuple[str, ...]
    ros: int = 1

    @property
    def is_closed(self) -> bool:
        """Whether nothing is open but what the plan accepts."""
        return all(end.accepted for end in self.unenforceable)


def guarded_to_json(guarded: Guarded) -> dict[str, Any]:
    """Return the report as a JSON document."""
    return {"schema": "rtron.instrumented/1", **asdict(guarded)}


def guarded_text(guarded: Guarded) -> Report:
    """Return the report: each node's remaps, the ends that stay open, and how to start the app."""
    return Report(lambda page: _lines(guarded, page))


def _lines(guarded: Guarded, page: Page) -> Iterator[Text]:
    nodes = len({remap.node for remap in guarded.remaps})
    remaps = counted(len(guarded.remaps), "remap")
    yield line((guarded.launch, "bold"), f"  {remaps} on {counted(nodes, 'node')}")
    yield from _remaps(guarded.remaps)
    yield from _open_ends("Unenforceable", "bold red", guarded.unenforceable, page, accepted=False)
    yield from _open_ends("Accepted", "yellow", guarded.unenforceable, page, accepted=True)
    if guarded.notes:
        yield from heading("Notes")
    for note in guarded.notes:
        yield from paragraph(note, page, indent=2)
    yield from _next_step(guarded, page)


def _remaps(remaps: Sequence[NodeRemap]) -> Iterator[Text]:
    for node, group in groupby(sorted(remaps, key=_node_of), key=_node_of):
        yield from heading(node)
        rows = [(remap.written, "to", remap.target) for remap in group]
        yield from columns(rows, ("cyan", "dim", ""), indent=2)


def _node_of(remap: NodeRemap) -> str:
    return remap.node


def _open_ends(
    title: str, style: str, ends: Sequence[OpenEnd], page: Page, *, accepted: bool
) -> Iterator[Text]:
    chosen = [end for end in ends if end.accepted is accepted]
    if chosen:
        yield from heading(f"{title} ({len(chosen)})")
    for end in chosen:
        yield line((end.what, style), indent=2)
        yield from paragraph(end.why, page, indent=4)


def _next_step(guarded: Guarded, page: Page) -> Iterator[Text]:
    yield from heading("Next")
    if not guarded.is_closed:
        advice = "close what is unenforceable, or name it in the plan's accept_unenforceable"
        yield from paragraph(advice, page, indent=2)
    start = "roslaunch" if guarded.ros == 1 else "ros2 launch"
    yield line((f"{start} {quote(guarded.launch)}", "bold green"), indent=2)

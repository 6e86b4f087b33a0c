"""Who can interfere with whom: each topic that several nodes publish, drawn as a small flow."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from rich.cells import cell_len
from rich.text import Text

from rtron.reports.app.risk_list import (
    KIND_TITLE,
    SEVERITY_STYLE,
    evidence_lines,
    severity_mark,
    worst_first,
)
from rtron.reports.text_layout import TextPage, heading, line
from rtron.sanitize import sanitize
from rtron.vocabulary import InteractionGraph, Risk, RiskKind, RiskReport, RiskRole, Trust

MOST_ROWS = 12
_INDENT = 10


@dataclass(frozen=True, slots=True)
class TopicFlow:
    """Who speaks through what to whom; `style` is the middle's."""

    publishers: tuple[str, ...]
    topic: str
    successors: tuple[str, ...]
    style: str = "bold"


@dataclass(frozen=True, slots=True)
class _Pen:
    """The junctions of one side, each at the top, between and at the bottom.

    `turns` are those of the rows beside the middle's row, `meets` those in it.
    """

    turns: str
    meets: str

    def at(self, index: int, count: int) -> str:
        """Return the junction at the row `index` of `count` rows."""
        if count == 1:
            return "─"
        height = 0 if index == 0 else 2 if index == count - 1 else 1
        return (self.meets if index == _meeting_row(count) else self.turns)[height]


_LEFT, _RIGHT = _Pen("┐┤┘", "┬┼┴"), _Pen("┌├└", "┬┼┴")
_ASCII = str.maketrans("┐┤┘┌├└┬┼┴─►…", "+++++++++->~")
_JOINT = " ─┼─► "


def draw_topic_flow(flow: TopicFlow, page: TextPage, *, indent: int = 0) -> list[Text]:
    """Return the drawing, side by side where the page is wide enough, else one below another."""
    left, right = _shortened(flow.publishers), _shortened(flow.successors)
    middle = Text(sanitize(flow.topic), flow.style)
    needed = _width(left) + len(_JOINT) + middle.cell_len + len(_JOINT) + _width(right)
    drawing = _side_by_side if indent + needed <= page.width else _stacked
    rows = [line(indent=indent).append_text(row) for row in drawing(left, middle, right)]
    return [_in_ascii(row) for row in rows] if page.ascii_only else rows


def _side_by_side(left: Sequence[str], middle: Text, right: Sequence[str]) -> Iterator[Text]:
    height = max(len(left), len(right), 1)
    centre = _meeting_row(height)
    for row in range(height):
        text = Text(_left_cell(left, row - centre + _meeting_row(len(left))))
        text.append_text(middle if row == centre else Text(" " * middle.cell_len))
        text.append(_right_cell(right, row - centre + _meeting_row(len(right))))
        text.rstrip()
        yield text


def _left_cell(names: Sequence[str], index: int) -> str:
    if not 0 <= index < len(names):
        return " " * (_width(names) + len(_JOINT) if names else 0)
    dashes = "─" * (_width(names) - cell_len(names[index]) + 1)
    arrow = "─► " if index == _meeting_row(len(names)) else "   "
    return f"{names[index]} {dashes}{_LEFT.at(index, len(names))}{arrow}"


def _right_cell(names: Sequence[str], index: int) -> str:
    if not 0 <= index < len(names):
        return ""
    stem = " ─" if index == _meeting_row(len(names)) else "  "
    return f"{stem}{_RIGHT.at(index, len(names))}─► {names[index]}"


def _stacked(left: Sequence[str], middle: Text, right: Sequence[str]) -> Iterator[Text]:
    yield middle
    for label, names in (("from", left), ("to", right)):
        for index, name in enumerate(names):
            yield Text(f"  {label if index == 0 else '':<4}  {name}")


def _meeting_row(count: int) -> int:
    return max(count - 1, 0) // 2


def _width(names: Sequence[str]) -> int:
    return max(map(cell_len, names), default=0)


def _shortened(names: Sequence[str]) -> list[str]:
    if len(names) <= MOST_ROWS:
        return [sanitize(name) for name in names]
    shown = [sanitize(name) for name in names[: MOST_ROWS - 1]]
    return [*shown, f"… {len(names) - len(shown)} more"]


def _in_ascii(text: Text) -> Text:
    text.plain = text.plain.translate(_ASCII)
    return text


def contention(graph: InteractionGraph, report: RiskReport, page: TextPage) -> Iterator[Text]:
    """Yield a drawing for each risk of GR-ST, the worst first; nothing where there is none."""
    contended = [risk for risk in report.risks if risk.kind is RiskKind.GR_ST]
    if not contended:
        return
    foreign = frozenset(n.name for n in graph.nodes if n.trust is Trust.THIRD_PARTY)
    title = f"{RiskKind.GR_ST}: {KIND_TITLE[RiskKind.GR_ST]} ({len(contended)})"
    yield from heading("Who can interfere with whom")
    yield line(title, indent=2)
    for risk in sorted(contended, key=worst_first):
        yield _title(risk, report)
        yield from _drawings(risk, foreign, page)
        yield from evidence_lines(risk, indent=_INDENT)


def _title(risk: Risk, report: RiskReport) -> Text:
    sharing = [
        str(report.topic_classes[topic].sharing)
        for topic in risk.topics
        if topic in report.topic_classes
    ]
    details = ", ".join((risk.message_type, str(risk.domain), *sharing))
    return line(severity_mark(risk), details, indent=2)


def _drawings(risk: Risk, foreign: frozenset[str], page: TextPage) -> Iterator[Text]:
    publishers = risk.role_nodes.get(RiskRole.PUBLISHER, ())
    for topic in risk.topics:
        flow = TopicFlow(
            publishers=tuple(_marked(name, foreign) for name in publishers),
            topic=topic,
            successors=risk.successors,
            style=SEVERITY_STYLE[risk.severity],
        )
        yield from draw_topic_flow(flow, page, indent=_INDENT)


def _marked(name: str, foreign: frozenset[str]) -> str:
    return f"{name} (third party)" if name in foreign else name

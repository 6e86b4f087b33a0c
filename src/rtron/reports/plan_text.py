"""A plan as text: the coordination nodes, what flows through them, their policies and modes."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain

from rich.text import Text

from rtron.reports.lines import Page, Report, columns, counted, heading, line
from rtron.reports.problems_text import Remark, remark_lines
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    SECOND,
    UNAPPROVED,
    Flow,
    FpsMonitor,
    GuardedTopic,
    Mode,
    Plan,
    WatchedFlow,
)

_MODE_STYLE = {Mode.ENFORCE: "bold green", Mode.OBSERVE: "yellow"}
_CELL_STYLES = ("cyan", "", "", "dim")
_Rows = list[tuple[str, ...]]


def plan_text(plan: Plan, next_step: str = "", remarks: Sequence[Remark] = ()) -> Report:
    """Return the plan, what it leaves open, and the command that puts it to use."""
    return Report(lambda page: _lines(plan, next_step, remarks, page))


def _lines(plan: Plan, next_step: str, remarks: Sequence[Remark], page: Page) -> Iterator[Text]:
    yield line((plan.app or "app", "bold"), f"  plan for ROS {plan.ros}, revision {plan.revision}")
    yield line(_summary(plan))
    yield from chain.from_iterable(_grcn(g) for g in plan.grcn if g.mode is Mode.ENFORCE)
    yield from _rsrcn(plan.rsrcn) if plan.rsrcn else ()
    yield from _msrcn(plan.msrcn) if plan.msrcn else ()
    yield from _observed([g for g in plan.grcn if g.mode is Mode.OBSERVE])
    yield from _fps_monitors(plan.fps_monitor)
    if remarks:
        yield from heading(f"Left out ({len(remarks)})")
        yield from remark_lines(remarks, page)
    if next_step:
        yield from heading("Next")
        yield line((next_step, "bold green"), indent=2)


def _summary(plan: Plan) -> str:
    enforced = sum(grcn.mode is Mode.ENFORCE for grcn in plan.grcn)
    counts = [
        f"GRCN {len(plan.grcn)} ({enforced} enforce)",
        f"RSRCN {int(plan.rsrcn is not None)}",
        f"MSRCN {int(plan.msrcn is not None)}",
        f"fps_monitor {len(plan.fps_monitor)}",
    ]
    return ", ".join(counts)


def _grcn(grcn: GRCN) -> Iterator[Text]:
    yield from _title("GRCN", grcn)
    yield line(f"{grcn.topic}  {grcn.type}", f", {grcn.domain}, {grcn.sharing}", indent=2)
    rows = _flow_rows(grcn.flows)
    rows.append((UNAPPROVED, "any other node", _state(blocked=grcn.block_unapproved), ""))
    yield from columns(rows + _to(grcn.successors), _CELL_STYLES, indent=2)


def _observed(nodes: Sequence[GRCN]) -> Iterator[Text]:
    """Yield a row for each GRCN that decides nothing."""
    if nodes:
        yield from heading(f"GRCN that only observe ({len(nodes)})")
    rows = [(g.topic, str(g.domain), str(g.policy), counted(len(g.flows), "flow")) for g in nodes]
    yield from columns(rows, ("cyan",), indent=2)


def _rsrcn(node: RSRCN) -> Iterator[Text]:
    yield from _title("RSRCN", node)
    yield from chain.from_iterable(_guarded(topic) for topic in node.vflows)
    yield from _watched(node.iflows)


def _msrcn(node: MSRCN) -> Iterator[Text]:
    yield from _title("MSRCN", node)
    yield from chain.from_iterable(_guarded(topic) for topic in node.aflows)
    yield from _watched(node.eflows)


def _fps_monitors(monitors: Sequence[FpsMonitor]) -> Iterator[Text]:
    if monitors:
        yield from heading(f"fps_monitor ({len(monitors)})")
    rows = [(monitor.node, "on", monitor.topic) for monitor in monitors]
    yield from columns(rows, ("cyan", "dim"), indent=2)


def _title(kind: str, node: GRCN | RSRCN | MSRCN) -> Iterable[Text]:
    mode = (str(node.mode), _MODE_STYLE[node.mode])
    return Text(), line((node.id, "bold"), f"  {kind}  {node.policy}  ", mode)


def _guarded(topic: GuardedTopic) -> Iterator[Text]:
    yield line(f"{topic.topic}  {topic.type}", indent=2)
    yield from columns(_flow_rows(topic.flows) + _to(topic.successors), _CELL_STYLES, indent=4)


def _watched(flows: Sequence[WatchedFlow]) -> list[Text]:
    rows = [(flow.name, flow.publisher, f"watched on {flow.topic}") for flow in flows]
    return columns(rows, _CELL_STYLES, indent=2)


def _flow_rows(flows: Sequence[Flow]) -> _Rows:
    return [(flow.name, flow.publisher, _state(blocked=flow.block), _terms(flow)) for flow in flows]


def _state(*, blocked: bool) -> str:
    return "block" if blocked else "pass"


def _terms(flow: Flow) -> str:
    priority = f"priority {flow.priority}" if flow.priority else ""
    timeout = "" if flow.timeout is None else f"timeout {flow.timeout / SECOND:g} s"
    return ", ".join(filter(None, (priority, timeout)))


def _to(successors: Sequence[str]) -> _Rows:
    return [("" if index else "to", name, "", "") for index, name in enumerate(successors)]

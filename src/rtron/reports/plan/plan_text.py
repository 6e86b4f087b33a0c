"""A plan as text: the coordination nodes, what flows through them, their policies and modes."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain

from rich.text import Text

from rtron.coherence import guards_nothing
from rtron.reports.app.node_endpoints import node_functions
from rtron.reports.plan.descriptions import (
    describe_area,
    describe_audit,
    describe_event,
    describe_flow,
    describe_incidents,
    describe_limit,
    describe_monitor,
    describe_rule,
    describe_stop,
    describe_supervision,
    describe_transform,
    one_line,
    seconds,
)
from rtron.reports.plan.problems import Remark, remark_lines, void_lines
from rtron.reports.text_layout import Report, TextPage, columns, counted, heading, line, paragraph
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    UNAPPROVED,
    Audit,
    Flow,
    FpsMonitor,
    GuardedTopic,
    IncidentRecording,
    Mode,
    Node,
    Plan,
    Ros1ActionTopic,
    StopProfile,
    StopSources,
    Supervision,
    action_name,
    is_action_type,
)

_MODE_STYLE = {Mode.ENFORCE: "bold green", Mode.OBSERVE: "yellow"}
_CELL_STYLES = ("cyan", "", "", "dim")
_Rows = list[tuple[str, ...]]


def plan_text(
    plan: Plan,
    next_steps: Sequence[str] = (),
    remarks: Sequence[Remark] = (),
    nodes: Sequence[Node] = (),
    doubts: Sequence[Remark] = (),
    *,
    guess: str = "",
) -> Report:
    """Return the plan, what it leaves open, and the commands that put it to use.

    `nodes` are those of the app: the functions of those that the plan guards are shown. `doubts`
    are what somebody has to decide, `guess` is what was guessed of the app.
    """
    ours = frozenset(flow.publisher for flow in _flows(plan))
    guarded = [node for node in nodes if node.name in ours]
    return Report(
        lambda page: chain(
            _lines(plan, guess, page),
            _remarks("Left out", remarks, page),
            _remarks("To decide", doubts, page),
            node_functions(guarded, page),
            _next(next_steps),
        )
    )


def _flows(plan: Plan) -> Iterator[Flow]:
    yield from chain.from_iterable(grcn.flows for grcn in plan.grcn)
    vflows = plan.rsrcn.vflows if plan.rsrcn else ()
    aflows = plan.msrcn.aflows if plan.msrcn else ()
    yield from chain.from_iterable(topic.flows for topic in (*vflows, *aflows))


def _next(steps: Sequence[str]) -> Iterator[Text]:
    if steps:
        yield from heading("Next")
        yield from (line((step, "bold green"), indent=2) for step in steps)


def _remarks(title: str, remarks: Sequence[Remark], page: TextPage) -> Iterator[Text]:
    if remarks:
        yield from heading(f"{title} ({len(remarks)})")
        yield from remark_lines(remarks, page)


def _lines(plan: Plan, guess: str, page: TextPage) -> Iterator[Text]:
    yield from void_lines(is_void=guards_nothing(plan))
    yield line((plan.app or "app", "bold"), f"  plan for ROS {plan.ros}, revision {plan.revision}")
    yield line(_summary(plan))
    yield from paragraph(guess, page, style="dim") if guess else ()
    yield from chain.from_iterable(_grcn(g) for g in plan.grcn if g.mode is Mode.ENFORCE)
    yield from _rsrcn(plan.rsrcn, page) if plan.rsrcn else ()
    yield from _msrcn(plan.msrcn, page) if plan.msrcn else ()
    yield from _observed([g for g in plan.grcn if g.mode is Mode.OBSERVE])
    yield from _fps_monitors(plan.fps_monitor)
    yield from _leases(plan)
    yield from _stop(plan.stop)
    yield from _stop_sources(plan.stop_sources)
    yield from _audit(plan.audit)
    yield from _supervision(plan.supervision)
    yield from _incidents(plan.incidents)


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
    yield from _topic(grcn, f", {grcn.domain}, {grcn.sharing}")
    rows = _flow_rows(grcn.flows)
    rows.append((UNAPPROVED, "any other node", _state(blocked=grcn.block_unapproved), ""))
    yield from columns(rows + _to(grcn.successors), _CELL_STYLES, indent=2)


def _observed(nodes: Sequence[GRCN]) -> Iterator[Text]:
    """Yield a row for each GRCN that decides nothing."""
    if nodes:
        yield from heading(f"GRCN that only observe ({len(nodes)})")
    rows = [(g.topic, str(g.domain), str(g.policy), counted(len(g.flows), "flow")) for g in nodes]
    yield from columns(rows, ("cyan",), indent=2)


def _rsrcn(node: RSRCN, page: TextPage) -> Iterator[Text]:
    yield from _title("RSRCN", node)
    yield from paragraph(", ".join(describe_limit(node)), page, indent=2)
    yield from chain.from_iterable(_guarded(topic) for topic in node.vflows)
    rows = [(flow.name, flow.publisher, f"watched on {flow.topic}") for flow in node.iflows]
    yield from columns(rows, _CELL_STYLES, indent=2)


def _msrcn(node: MSRCN, page: TextPage) -> Iterator[Text]:
    yield from _title("MSRCN", node)
    yield from chain.from_iterable(_guarded(topic) for topic in node.aflows)
    for flow in node.eflows:
        yield line((flow.name, "cyan"), f"  {flow.publisher}  event on {flow.topic}", indent=2)
        yield from paragraph(describe_event(flow), page, indent=4, style="dim")
    for rule in node.rules:
        yield line("rule ", (rule.name, "cyan"), indent=2)
        yield from paragraph(describe_rule(rule), page, indent=4)
        yield from paragraph(one_line(rule.reason), page, indent=4, style="dim")
    rows = [("area", area.name, describe_area(area)) for area in node.areas]
    yield from columns(rows, ("", "cyan", "dim"), indent=2)
    yield from (line(describe_transform(one), indent=2) for one in node.transforms)


def _fps_monitors(monitors: Sequence[FpsMonitor]) -> Iterator[Text]:
    if monitors:
        yield from heading(f"fps_monitor ({len(monitors)})")
    for monitor in monitors:
        yield line((monitor.node, "cyan"), ("  on  ", "dim"), monitor.topic, indent=2)
        yield line((describe_monitor(monitor), "dim"), indent=4)


def _leases(plan: Plan) -> Iterator[Text]:
    if plan.leases:
        yield from heading(f"Leases ({len(plan.leases)})")
    for lease in plan.leases:
        topics = ", ".join(grcn.topic for grcn in plan.grcn if grcn.lease == lease.name)
        text = f"  for {topics}; it ends {seconds(lease.ttl)} after it was renewed last"
        yield line((lease.name, "cyan"), text, indent=2)


def _stop_sources(sources: StopSources) -> Iterator[Text]:
    if sources != StopSources():
        yield from heading("Stop sources")
    for button in sources.buttons:
        yield line((button.name, "cyan"), f"  {button.publisher} on {button.topic}", indent=2)
    if sources.second_person is not None:
        within = seconds(sources.second_person)
        yield line(f"a second person must release each stop within {within}", indent=2)


def _stop(stop: StopProfile) -> Iterator[Text]:
    if stop != StopProfile():
        yield from heading("Stop")
        yield line(describe_stop(stop), indent=2)


def _audit(audit: Audit) -> Iterator[Text]:
    if audit != Audit():
        yield from heading("Audit")
        yield line(describe_audit(audit), indent=2)


def _supervision(bounds: Supervision) -> Iterator[Text]:
    if bounds != Supervision():
        yield from heading("Supervision")
        yield line(describe_supervision(bounds), indent=2)


def _incidents(recording: IncidentRecording) -> Iterator[Text]:
    if recording != IncidentRecording():
        yield from heading("Incidents")
        yield line(describe_incidents(recording), indent=2)


def _title(kind: str, node: GRCN | RSRCN | MSRCN) -> Iterable[Text]:
    mode = (str(node.mode), _MODE_STYLE[node.mode])
    return Text(), line((node.id, "bold"), f"  {kind}  {node.policy}  ", mode)


def _guarded(topic: GuardedTopic) -> Iterator[Text]:
    yield from _topic(topic)
    yield from columns(_flow_rows(topic.flows) + _to(topic.successors), _CELL_STYLES, indent=4)


def _topic(guarded: GRCN | GuardedTopic, more: str = "") -> Iterator[Text]:
    """Yield what is guarded; the goals of an action stand for all of its topics."""
    yield line(f"{guarded.topic}  {guarded.type}", more, indent=2)
    action = action_name(guarded.topic, guarded.type)
    if is_action_type(guarded.type):
        yield line(
            (f"its goals, cancels and results are requests: {action} is one action", "dim"),
            indent=2,
        )
    elif action:
        parts = ", ".join(part for part in Ros1ActionTopic if part is not Ros1ActionTopic.GOAL)
        yield line((f"with {parts}: {action} is one action", "dim"), indent=2)


def _flow_rows(flows: Sequence[Flow]) -> _Rows:
    return [
        (flow.name, flow.publisher, _state(blocked=flow.block), describe_flow(flow))
        for flow in flows
    ]


def _state(*, blocked: bool) -> str:
    return "block" if blocked else "pass"


def _to(successors: Sequence[str]) -> _Rows:
    return [("" if index else "to", name, "", "") for index, name in enumerate(successors)]

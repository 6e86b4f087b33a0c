"""The output of `rtron settings`."""

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from rtron.sanitize import sanitize

if TYPE_CHECKING:
    from rich.text import Text

    from rtron.reports.text_layout import Report

_View = Mapping[str, Any]
_OUTCOMES = {
    "pending": "sent; the guard has not answered yet",
    "applied": "active",
    "refused": "REJECTED by the guard",
    "replaced": "superseded by a newer revision",
}
_SETTABLE = ("policy", "release_after", "max_age", "max_hold", "threshold", "max_vel_limit")
_DURATIONS = ("release_after", "max_age", "max_hold", "timeout")
_UNITS = {"threshold": "m/frame", "max_vel_limit": "m/s"}


def outcome_line(view: _View) -> str:
    """Return the outcome of a revision, on one line."""
    error = f": {view['error']}" if view["error"] else ""
    return f"revision {view['revision']}: {_OUTCOMES[view['outcome']]}{error}\n"


def stop_line(view: _View) -> str:
    """Return on one line who has stopped the robot, and why."""
    stop = view["settings"]["stop"]
    return f"stopped by {sanitize(_who_and_why(stop))}\n" if stop else ""


def nodes_report(robot: str, view: _View, nodes: Sequence[_View]) -> "Report":
    """Return the coordination nodes of a robot, a line each."""
    from rtron.reports.text_layout import Report

    return Report(lambda _: [*_heading(robot, view), *_node_rows(nodes)])


def node_report(view: _View, node: _View) -> "Report":
    """Return all of one coordination node that can be set, beside what the plan says."""
    from rtron.reports.text_layout import Report

    return Report(lambda _: _node_lines(view, node))


def _heading(robot: str, view: _View) -> "Iterator[Text]":
    from rtron.reports.text_layout import line

    by = f", by {view['by']}" + (f": {view['reason']}" if view["reason"] else "")
    yield line((robot, "bold"), f"  {outcome_line(view).rstrip()}{by}")
    yield from _stop_lines(view)


def _stop_lines(view: _View) -> "Iterator[Text]":
    from rtron.reports.text_layout import line

    stop = view["settings"]["stop"]
    if stop:
        yield line((f"EMERGENCY STOP by {_who_and_why(stop)}", "bold red"))


def _who_and_why(stop: _View) -> str:
    return f"{stop['by']}" + (f": {stop['reason']}" if stop["reason"] else "")


def _node_rows(nodes: Sequence[_View]) -> "Iterator[Text]":
    from rich.text import Text

    from rtron.reports.text_layout import columns

    yield Text()
    rows = [
        (node["id"], node["type"], _policy(node), _override(node), " ".join(node["topics"]))
        for node in nodes
    ]
    yield from columns(rows, ("bold", "cyan"), indent=2) if rows else ()


def _policy(node: _View) -> str:
    now, planned = node["effective"].get("policy", ""), node["plan"].get("policy", "")
    return str(now) if now == planned else f"{now} (plan: {planned})"


def _override(node: _View) -> str:
    return f"overridden by {node['override']['by']}" if node["override"] else ""


def _node_lines(view: _View, node: _View) -> "Iterator[Text]":
    from rich.text import Text

    from rtron.reports.text_layout import columns, heading, line

    yield line((node["id"], "bold"), f"  {node['type']}  {node['description']}")
    yield line(outcome_line(view).rstrip(), indent=2)
    yield from _stop_lines(view)
    if node["violation_cause"]:
        yield from heading("Last violation")
        for key in ("violated_rule", "violation_cause", "violation_details"):
            yield line(node[key], indent=2)
    yield from heading("Settings")
    yield from columns(list(_setting_rows(node)), ("bold",), indent=2)
    yield Text()
    rights = ", ".join(node["rights"]) or "read only"
    yield line(("You may: ", "dim"), rights)


def _setting_rows(node: _View) -> Iterator[tuple[str, str, str]]:
    now, planned = node["effective"], node["plan"]
    for key in _SETTABLE:
        if now.get(key) is not None:
            yield _row(key, key, now, planned)
    was = {flow["name"]: flow for flow in _flows(planned)}
    for flow in _flows(now):
        for key in ("priority", "block", "timeout"):
            if flow[key] is not None:
                yield _row(f"{flow['name']}.{key}", key, flow, was[flow["name"]])
    yield from _rule_rows(node)


def _rule_rows(node: _View) -> Iterator[tuple[str, str, str]]:
    planned = {rule["name"]: rule for rule in node["plan"].get("rules", ())}
    now = {rule["name"]: rule for rule in node["effective"].get("rules", ())}
    for name in {**planned, **now}:
        rule = now.get(name) or planned[name]
        description = f"while {rule['when']} blocks {', '.join(rule['block'])}"
        mark = "" if name in planned else "your own"
        mark = "mandatory" if name in node["mandatory"] else mark
        yield name, description if name in now else f"not selected ({description})", mark


def _flows(node: _View) -> Iterator[_View]:
    yield from node.get("flows", ())
    for topic in (*node.get("vflows", ()), *node.get("aflows", ())):
        yield from topic["flows"]


def _row(name: str, key: str, now: _View, planned: _View) -> tuple[str, str, str]:
    value, was = _format_value(key, now[key]), _format_value(key, planned[key])
    return name, value, "" if value == was else f"plan: {was}"


def _format_value(key: str, value: Any) -> str:  # noqa: ANN401 - JSON
    from rtron.planning.plan_file.quantities import write_duration

    if value is None:
        return "none"
    if key in _DURATIONS:
        return write_duration(value)
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:g} {_UNITS[key]}" if key in _UNITS else str(value)

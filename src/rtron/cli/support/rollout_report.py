"""The output of `rtron rollout`, and what its options say."""

from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime
from typing import TYPE_CHECKING, Any

from rtron.errors import InputError, suggestion
from rtron.sanitize import sanitize

if TYPE_CHECKING:
    from rich.text import Text

    from rtron.reports.text_layout import Report

_View = Mapping[str, Any]
PROBLEMS = {
    "refused": "the guard, or the service, does not take the change",
    "alarm": "a new alarm",
    "blocked": "a higher share of blocked messages",
    "stopped": "stopped, by the guard or by a person",
    "restarted": "the guard began anew",
    "gone": "the guard is away, or does not answer",
}
"""What a robot may show after a change."""
_STATES = {"paused": "PAUSED", "reverting": "GOING BACK", "reverted": "WENT BACK"}
_OTHERS = {"reverted": "without it again", "stuck": "from which it could not be taken back"}
_SECOND = 1_000_000_000
_MAX_DIGITS = 9


def has_failed(view: _View) -> bool:
    """Tell whether the change is not, or does not stay, on all robots."""
    return view["state"] not in {"running", "paused", "done"} or view["stuck"] > 0


def parse_amount(text: str) -> int | str:
    """Return a number of robots as the API takes it: a number, or a text with a percent sign."""
    is_number = text.isascii() and text.isdigit() and len(text) <= _MAX_DIGITS
    return int(text) if is_number else text.strip()


def parse_stages(text: str) -> list[int | str]:
    """Return the stages of a text like "1,10%,100%"."""
    return [parse_amount(part.strip()) for part in text.split(",")]


def parse_limits(limits: Sequence[str]) -> dict[str, int | str]:
    """Return the limits of texts like "alarm=0" and "gone=5%"; InputError for other problems."""
    found = {}
    for limit in limits:
        problem, separator, amount = limit.partition("=")
        if not separator:
            raise InputError(f"what is {limit!r}?", help="give PROBLEM=AMOUNT, for example alarm=0")
        if problem not in PROBLEMS:
            raise InputError(
                f"no problem is called {problem!r}", help=suggestion(problem, PROBLEMS)
            )
        found[problem] = parse_amount(amount)
    return found


def rollout_line(view: _View) -> str:
    """Return what a roll-out is at, on one line that a terminal survives."""
    shown = ", ".join(f"{name} on {count}" for name, count in view["problems"].items())
    parts = (
        f"roll-out {view['id']}: {_state(view)}",
        "" if view["state"] == "done" else f"stage {view['stage'] + 1} of {len(view['targets'])}",
        _progress(view),
        shown and f"shown: {shown}",
        view["note"],
    )
    return sanitize("; ".join(filter(None, parts))) + "\n"


def rollouts_report(rollouts: Sequence[_View]) -> "Report":
    """Return roll-outs, a line each."""
    from rtron.reports.text_layout import Report, columns

    rows = list(map(_summary_row, rollouts))
    return Report(lambda _: columns(rows, ("bold", "cyan")) if rows else [])


def rollout_report(view: _View, robots: Sequence[_View]) -> "Report":
    """Return a roll-out in full, with a line for each of `robots`."""
    from rtron.reports.text_layout import Report

    return Report(lambda _: _lines(view, robots))


def _lines(view: _View, robots: Sequence[_View]) -> "Iterator[Text]":
    from rtron.reports.text_layout import columns, heading, line

    begun = f"begun {_time(view['created'])} by {view['by']}: {view['reason']}"
    yield line((f"roll-out {view['id']}", "bold"), f"  {_state(view)}, {begun}")
    yield line(_progress(view), indent=2)
    if view["note"]:
        yield line((view["note"], "bold" if has_failed(view) else ""), indent=2)
    yield from heading("Change")
    if view["plan"]:
        yield line(f"the plan {view['plan']}", indent=2)
    yield from columns(list(_change_rows(view["nodes"])), ("bold",), indent=2)
    yield from heading("Stages")
    yield from columns(list(_stage_rows(view)), ("bold",), indent=2)
    yield from heading("Watched")
    yield from columns(list(_limit_rows(view)), ("bold",), indent=2)
    if robots:
        yield from heading("Robots")
        yield from columns(list(map(_robot_row, robots)), ("bold",), indent=2)


def _state(view: _View) -> str:
    return _STATES.get(view["state"], str(view["state"]))


def _summary_row(view: _View) -> tuple[str, str, str, str, str, str]:
    why = view["note"] or view["reason"]
    begun = _time(view["created"])
    return str(view["id"]), _state(view), _progress(view), begun, view["by"], why


def _progress(view: _View) -> str:
    have = f"{view['sent']} of {view['total']} have the change"
    applied = f" ({view['applied']} in force)" if "applied" in view else ""
    others = [f"{view[key]} {word}" for key, word in _OTHERS.items() if view[key]]
    return ", ".join([have + applied, *others])


def _time(at: int) -> str:
    return f"{datetime.fromtimestamp(at // _SECOND).astimezone():%m-%d %H:%M:%S}"


def _change_rows(nodes: _View) -> Iterator[tuple[str, str, str]]:
    for node, values in nodes.items():
        for key, value in _settings(values):
            yield node, key, "as the plan" if value is None else str(value)


def _settings(values: _View) -> Iterator[tuple[str, Any]]:
    """Yield the settings of a change by their names in `rtron settings set`."""
    for key, value in values.items():
        if not isinstance(value, Mapping):
            yield key, value
            continue
        for name, part in value.items():
            inner = part if isinstance(part, Mapping) else {"": part}
            yield from ((f"{name}.{word}".rstrip("."), setting) for word, setting in inner.items())


def _stage_rows(view: _View) -> Iterator[tuple[str, str, str]]:
    reached, begun = view["total"] - view["waiting"], 0
    for number, target in enumerate(view["targets"], 1):
        got = min(max(reached - begun, 0), target - begun)
        begun = target
        yield f"{number}", f"up to {target}", f"{got} reached" if got else ""


def _limit_rows(view: _View) -> Iterator[tuple[str, str, str]]:
    from rtron.reports.text_layout import counted

    limits = view["policy"]["limits"]
    for problem, description in PROBLEMS.items():
        shown = view["problems"].get(problem, 0)
        yield problem, f"{counted(shown, 'robot')}, at most {limits[problem]}", description


def _robot_row(robot: _View) -> tuple[str, str, str, str, str]:
    problems = ", ".join(robot["problems"])
    return robot["robot"], robot["phase"], robot["outcome"] or "", problems, robot["note"]

"""What an inventory says of a thing, in rows of plain words, for each report alike."""

import re
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, NamedTuple

from rtron.vocabulary import StringEnum
from rtron.vocabulary.inventory import Command, Means, Mover, Stops
from rtron.wording import conjugate, join_names

_SHOWN = 8
_JOY = "sensor_msgs/Joy"
_NUMBER = re.compile(r"-?[0-9]{1,9}")


class Tone(StringEnum):
    """How a row is meant."""

    PLAIN = "plain"
    GOOD = "good"
    WARNING = "warning"
    UNCERTAIN = "uncertain"


class MoverRow(NamedTuple):
    """A row of words and how it is meant."""

    text: str
    tone: Tone = Tone.PLAIN


_UNREAD = "may obey any topic: what is behind it was not read"
_UNCOMMANDED = "moves it by itself, or obeys a device or link of its own: no topic commands it"
_OPERATED = "moves it as its operator says: no topic commands it"
_STOP_TONE = {Stops.YES: Tone.GOOD, Stops.NO: Tone.WARNING, Stops.UNKNOWN: Tone.UNCERTAIN}


def mover_rows(mover: Mover) -> Iterator[MoverRow]:
    """Yield what drives a thing, who commands it, what else can, and whether it stops."""
    last = mover.last_commands
    if not last:
        by_itself = _OPERATED if mover.operators else _UNCOMMANDED
        how = by_itself if mover.hardware else _UNREAD
        yield MoverRow(f"{_some(mover.drivers)}{_hardware(mover)} {how}", Tone.UNCERTAIN)
    for means in Means:
        commands = [each for each in last if each.means is means]
        yield from _MEANS_ROWS[means](mover, commands) if commands else ()
    if behind := _behind(mover):
        yield MoverRow(f"behind {_these(last)}: {_names(behind)}; any node can send there, too")
    for verb, sent in _OPEN.items():
        if spare := [each for each in _open(mover) if each.means in sent]:
            nobody = "nobody in this launch" if mover.is_whole else "nobody that was read"
            text = f"open: {nobody} {verb} {_names(spare)}; any node can"
            yield MoverRow(text, Tone.WARNING)
    yield from _source_rows(mover)
    if mover.doors:
        yield MoverRow(f"reached from a network through {join_names(mover.doors)}", Tone.WARNING)
    if mover.stop:
        yield MoverRow(
            f"stops when commands end: {mover.stops}; {mover.stop}", _STOP_TONE[mover.stops]
        )


def _source_rows(mover: Mover) -> Iterator[MoverRow]:
    """Yield what else is known of those that command and obey."""
    if mover.unprompted:
        who = _all(mover.unprompted)
        text = f"nothing in the source tells {who} to send: it may begin when the app starts"
        yield MoverRow(text, Tone.WARNING)
    if mover.starting:
        text = f"the source of {_all(mover.starting)} moves it untold, too: at its start, or later"
        yield MoverRow(text, Tone.WARNING)
    if mover.firmware:
        read = "what a sketch in the source obeys; another may be flashed"
        yield MoverRow(f"of the firmware of {_all(mover.firmware)}: {read}", Tone.UNCERTAIN)
    if mover.effect:
        yield MoverRow(mover.effect, Tone.UNCERTAIN)
    if mover.operators:
        yield MoverRow(f"a person commands it by {_all(mover.operators)}")


def _behind(mover: Mover) -> list[Command]:
    """Return what leads to the last commands, as far as no other row names it."""
    led = (c for c in mover.commands if c.hops and c.senders and "{" not in c.name)
    return [each for each in led if not _NUMBER.fullmatch(each.priority)]


def _these(last: Sequence[Command]) -> str:
    return "these" if last[1:] else "it"


def _hardware(mover: Mover) -> str:
    return f" ({', '.join(mover.hardware)})" if mover.hardware else ""


def _open(mover: Mover) -> list[Command]:
    """Return what no node sends, where its whole name is known; nobody sends parameters."""
    open_ = (c for c in mover.open_commands if c.means is not Means.PARAMETER)
    return [command for command in open_ if "{" not in command.name]


def _nobody(mover: Mover) -> str:
    """Return who obeys a command that nobody obeys: perhaps a node that was not read."""
    if not mover.unread:
        return "nobody in this launch"
    is_node = mover.unread[0].startswith("/")
    files = [name.removeprefix("include ").removeprefix("launch file ") for name in mover.unread]
    who = join_names(mover.unread) if is_node else f"what {join_names(files)} starts"
    return f"nobody that was read; {who} may"


def _topic_rows(mover: Mover, last: Sequence[Command]) -> Iterator[MoverRow]:
    if mover.drivers:
        verb = conjugate(mover.drivers, "obey")
        yield MoverRow(f"{_some(mover.drivers)}{_hardware(mover)} {verb} {_names(last)}")
    else:
        yield MoverRow(f"{_names(last)}, obeyed by {_nobody(mover)}")
    yield MoverRow(f"sent by {_sources(mover, last)}{_order(mover)}")


def _sources(mover: Mover, last: Sequence[Command]) -> str:
    """Return who sends commands, and who is behind them: through arbiters, or as their input."""
    direct = _senders(last)
    forwarders = {node for each in mover.commands if each.hops for node in each.receivers}
    sources = _senders(each for each in mover.commands if each.means is Means.TOPIC)
    arbiters = [node for node in mover.arbiters if node in sources]
    between = [*dict.fromkeys([*filter(forwarders.__contains__, direct), *arbiters])]
    behind = [node for node in sources if node not in (*direct, *between)]
    into = (each for each in mover.commands if not set(between).isdisjoint(each.receivers))
    passed = [node for node in _senders(c for c in into if c.type != _JOY) if node in behind]
    if arbiters and passed:
        between = _relays(mover, between, passed)
        past = [node for node in direct if node not in between]
        passing = f"{_all(past)} directly, and by " if past else ""
        behind_them = _instructed_by(node for node in behind if node not in passed)
        return f"{passing}{_all(passed)} through {_all(between)}{behind_them}"
    behind_them = _instructed_by(node for node in sources if node not in direct)
    return f"{_all(direct) or 'nobody in this launch'}{behind_them}"


def _relays(mover: Mover, between: Sequence[str], sources: Iterable[str]) -> list[str]:
    """Return which of some nodes hand on what the sources send."""
    found, behind = set(sources), [each for each in mover.commands if each.hops]
    for _ in between:
        reached = (each for each in behind if not found.isdisjoint(each.senders))
        found.update(node for each in reached if each.type != _JOY for node in each.receivers)
    return [node for node in between if node in found]


def _instructed_by(nodes: Iterable[str]) -> str:
    """Return who tells senders what to command, and sends no command to what obeys it."""
    names = _all(list(nodes))
    return f", told by {names}" if names else ""


def _all(names: Sequence[str]) -> str:
    """Return all names: who commands a robot is never one of `3 more`."""
    return " and ".join(filter(None, [", ".join(names[:-1]), *names[-1:]]))


def _request_rows(mover: Mover, last: Sequence[Command]) -> Iterator[MoverRow]:
    """Yield who serves and calls services, or takes and sends goals, and who tells these."""
    noun, verb = _REQUESTS[last[0].means]
    receivers = list(dict.fromkeys(node for each in last for node in each.receivers))
    obeyed = _some(receivers) or "nobody in this launch"
    direct = _senders(last)
    senders = _some(direct) or "nobody in this launch"
    behind = (c for c in mover.commands if c.hops and not set(direct).isdisjoint(c.receivers))
    has_topics = any(each.means is Means.TOPIC for each in mover.last_commands)
    instructed = (
        "" if has_topics else _instructed_by(n for n in _senders(behind) if n not in direct)
    )
    yield MoverRow(f"{noun} {_names(last)} of {obeyed}, {verb} {senders}{instructed}")


def _parameter_rows(mover: Mover, last: Sequence[Command]) -> Iterator[MoverRow]:
    del mover
    yield MoverRow(f"any node can set {_names(last)} while the app runs")


_OPEN = {"sends": (Means.TOPIC, Means.ACTION), "calls": (Means.SERVICE,)}
_REQUESTS = {Means.SERVICE: ("services", "called by"), Means.ACTION: ("goals", "sent by")}
_MEANS_ROWS = {
    Means.TOPIC: _topic_rows,
    Means.SERVICE: _request_rows,
    Means.ACTION: _request_rows,
    Means.PARAMETER: _parameter_rows,
}


def _senders(commands: Iterable[Command]) -> list[str]:
    return list(dict.fromkeys(node for each in commands for node in each.senders))


def _order(mover: Mover) -> str:
    """Return the inputs that an arbiter ranks, the first to win first."""
    ranked = [each for each in mover.commands if _NUMBER.fullmatch(each.priority)]
    ranked.sort(key=lambda each: -int(each.priority))
    shown = ", ".join(f"{each.name} ({each.priority})" for each in ranked)
    return f"; the first of {shown} wins" if shown else ""


def _names(commands: Sequence[Command]) -> str:
    return _some([each.name for each in commands])


def _some(names: Sequence[str]) -> str:
    """Return the first of many names, and how many more there are."""
    if len(names) > _SHOWN:
        names = [*names[: _SHOWN - 1], f"{len(names) - _SHOWN + 1} more"]
    return _all(names)


def rows_to_json(mover: Mover) -> dict[str, Any]:
    """Return a thing and its rows of words as JSON."""
    rows = [{"text": row.text, "tone": row.tone.value} for row in mover_rows(mover)]
    return {"thing": mover.thing.value, "rows": rows}


def inventory_to_json(movers: Sequence[Mover]) -> list[dict[str, Any]]:
    """Return an inventory as JSON, in words and in parts."""
    return [
        {
            **rows_to_json(mover),
            "drivers": list(mover.drivers),
            "hardware": list(mover.hardware),
            "commands": [_command(each) for each in mover.commands],
            "arbiters": list(mover.arbiters),
            "doors": list(mover.doors),
            "operators": list(mover.operators),
            "effect": mover.effect,
            "unread": list(mover.unread),
            "stops": mover.stops.value,
            "why": mover.stop,
            "evidence": [{"file": at.file, "line": at.line} for at in mover.evidence],
        }
        for mover in movers
    ]


def _command(command: Command) -> dict[str, Any]:
    return {
        "means": command.means.value,
        "name": command.name,
        "type": command.type,
        "receivers": list(command.receivers),
        "senders": list(command.senders),
        "hops": command.hops,
        "priority": command.priority,
    }

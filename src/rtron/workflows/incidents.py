"""Incidents that guards have saved: which there are, and what each is an account of.

Times in an account are ns after its first cause, negative before.
"""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from rtron.errors import InputError
from rtron.guard.system.state_folder import INCIDENTS, state_folder
from rtron.sources.bag.incident import (
    IncidentEntry,
    IncidentFile,
    PassedMessage,
    RecordedDecision,
    RecordedPose,
)
from rtron.vocabulary import (
    SECOND,
    IncidentAccount,
    IncidentEvent,
    ListedIncident,
    NotedChange,
    NotedPose,
    TopicAccount,
    Velocity,
)

MOST_ENTRIES = 1_000_000
LAST = "last"
_TWIST_COMPONENTS = ("linear_x", "linear_y", "linear_z", "angular_x", "angular_y", "angular_z")
ROW_KEYS = (
    "at",
    "seconds",
    "kind",
    "topic",
    "flow",
    "publisher",
    "speed",
    *_TWIST_COMPONENTS,
    "decision",
    "policy",
    "reason",
    "revision",
    "owner",
    "limit",
    "stopping",
    "bytes",
    "frame",
    "x",
    "y",
    "yaw",
)
"""The columns of an export: what each row of it may have."""


def incident_folder(app: str, state: Path | None) -> Path:
    """Return where the guard of an app saves incidents; `state` is its folder, if not the usual."""
    return (state or state_folder(app)) / INCIDENTS


def usual_folders() -> list[Path]:
    """Return where guards of this user have saved incidents, a folder for each app."""
    return sorted(state_folder("app").parent.glob(f"*/{INCIDENTS}"))


def find_incident(given: Path) -> Path:
    """Return the file that is meant: `given` itself, or the one of its name in a usual folder.

    `last` is the newest of those.
    """
    if given.exists() or len(given.parts) > 1:
        return given
    found = [path for folder in usual_folders() for path in folder.glob("*.mcap")]
    if given.name == LAST:
        return max(found, key=lambda path: path.name, default=given)
    return next((path for path in found if path.name == given.name), given)


def list_incidents(folder: Path) -> list[ListedIncident]:
    """Return the incidents in a folder, the oldest first; InputError if it cannot be read."""
    try:
        paths = sorted(folder.glob("*.mcap")) if folder.is_dir() else None
    except OSError as error:
        raise InputError(error.strerror or "cannot be read", path=str(folder)) from None
    if paths is None:
        help = "give the folder with --dir, or the app with --app; the guard makes it"
        raise InputError("no such folder", path=str(folder), help=help)
    return [_listed(path) for path in paths]


def _listed(path: Path) -> ListedIncident:
    size = path.stat().st_size if path.exists() else 0
    try:
        return ListedIncident(name=path.name, size=size, header=IncidentFile(path).header)
    except InputError as error:
        return ListedIncident(name=path.name, size=size, header=None, problem=str(error))


def read_account(incident: IncidentFile) -> IncidentAccount:
    """Return what an incident tells; InputError where the file is damaged."""
    first = incident.header.causes[0].at
    topics: dict[str, TopicAccount] = {}
    events: list[IncidentEvent] = []
    poses: dict[str, list[NotedPose]] = {}
    for entry in bounded_entries(incident):
        at = entry.at - first
        if isinstance(entry, PassedMessage):
            _note_message(topics.setdefault(entry.topic, TopicAccount()), at, entry)
        elif isinstance(entry, RecordedPose):
            poses.setdefault(entry.topic, []).append(NotedPose(at, *entry.pose))
        else:
            _note_decision(topics, events, at, entry)
    return IncidentAccount(header=incident.header, topics=topics, events=tuple(events), poses=poses)


def bounded_entries(incident: IncidentFile) -> Iterator[IncidentEntry]:
    """Yield the entries of an incident; InputError if there are more than any guard saves."""
    for number, entry in enumerate(incident.entries()):
        if number >= MOST_ENTRIES:
            help = "no guard saves so many; export it with the `mcap` command line instead"
            path = str(incident.path)
            raise InputError(f"more than {MOST_ENTRIES} messages", path=path, help=help)
        yield entry


def _note_message(account: TopicAccount, at: int, message: PassedMessage) -> None:
    if message.flow:
        account.publishers.setdefault(message.flow, message.publisher)
    if message.velocity is None:
        return
    curve = account.commands.setdefault(message.flow, []) if message.flow else account.output
    curve.append((at, message.velocity))


def _note_decision(
    topics: dict[str, TopicAccount],
    events: list[IncidentEvent],
    at: int,
    decision: RecordedDecision,
) -> None:
    kind, topic, text = decision.text("kind"), decision.text("topic"), decision.text
    if kind == "verdict":
        account = topics.setdefault(topic, TopicAccount())
        account.publishers.setdefault(text("flow"), text("publisher"))
        account.note_verdict(
            NotedChange(at, text("flow"), text("decision"), text("policy"), text("reason"))
        )
    elif kind == "control":
        owner = (text("owner"), text("publisher"), text("stopping"))
        account = topics.setdefault(topic, TopicAccount())
        account.note_control(at, owner, decision.number("limit"))
    elif kind in _REASONS:
        events.append(IncidentEvent(at, kind, topic, _REASONS[kind](decision)))


def _alarm_text(decision: RecordedDecision) -> str:
    over = "" if decision.document.get("active") else "no more: "
    return f"{over}{decision.text('alarm')}: {decision.text('reason')}"


def _rule_text(decision: RecordedDecision) -> str:
    state = "blocks" if decision.document.get("blocks") else "is free"
    return f"{decision.text('rule')} {state}: {decision.text('reason')}"


def _lease_text(decision: RecordedDecision) -> str:
    answer = "granted" if decision.document.get("granted") else "refused"
    lease, request = decision.text("lease"), decision.text("request")
    return f"{lease}: {request} is {answer}: {decision.text('reason')}"


_REASONS: Mapping[str, Callable[[RecordedDecision], str]] = {
    "alarm": _alarm_text,
    "rule": _rule_text,
    "lease": _lease_text,
    "settings": lambda each: f"revision {each.number('revision') or 0:.0f} is in force",
    "lost": lambda each: f"{each.number('count') or 0:.0f} entries were lost on their way",
}


def export_rows(incident: IncidentFile) -> Iterator[dict[str, Any]]:
    """Yield a row for each message and each decision; a decision's has all of its document.

    `at` is in ns since 1970, `seconds` after the first cause.
    """
    first = incident.header.causes[0].at
    for entry in bounded_entries(incident):
        seconds = round((entry.at - first) / SECOND, 6)
        yield {**_row(entry), "at": entry.at, "seconds": seconds}


def _row(entry: IncidentEntry) -> Mapping[str, Any]:
    if isinstance(entry, PassedMessage):
        return _message_row(entry)
    if isinstance(entry, RecordedPose):
        return {"kind": "pose", "topic": entry.topic, **entry.pose._asdict()}
    return entry.document


def _message_row(message: PassedMessage) -> dict[str, Any]:
    row: dict[str, Any] = {
        "kind": "command" if message.flow else "output",
        "topic": message.topic,
        "flow": message.flow,
        "publisher": message.publisher,
        "bytes": len(message.data),
    }
    if message.velocity and message.velocity.is_finite:
        row["speed"] = message.velocity.speed
        row |= _components(message.velocity)
    return row


def _components(velocity: Velocity) -> dict[str, float]:
    linear = dict(zip(_TWIST_COMPONENTS[:3], velocity.linear, strict=False))
    return linear | dict(zip(_TWIST_COMPONENTS[3:], velocity.angular, strict=False))

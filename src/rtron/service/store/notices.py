"""What one replica tells the others: PostgreSQL's NOTIFY, in the transaction that makes it so.

Nothing is told that is not committed. With SQLite there is one process, and nobody to tell.

Every role of a PostgreSQL server that may connect to a database may use any channel there: it could
stop robots, or reset throttles. So the channel's name is a secret, in a table.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import count
from typing import Annotated, Literal, TypeAlias

from pydantic import Field, TypeAdapter
from sqlalchemy import ARRAY, String, Text, cast, func, select
from sqlalchemy.orm import Mapped, Session, mapped_column

from rtron.service.store.tables import Table
from rtron.wire.common.link_protocol import CommandResponse, PersonCommand

CHANNEL = "channel"
"""Under this key a session's `info` has the name of the channel."""
SENDER = "replica"
"""Under this key a session's `info` has the number of its replica."""


class NoticeChannelRow(Table):
    """The name of the channel; who cannot read it neither hears notices nor forges any."""

    __tablename__ = "notice_channel"

    name: Mapped[str] = mapped_column(String(63), primary_key=True)


@dataclass(frozen=True, slots=True, kw_only=True)
class SettingsNotice:
    """A robot has new settings, or an answer to them: a revision of one of its apps."""

    type: Literal["settings"] = "settings"
    robot: str
    app_id: int
    revision: int


@dataclass(frozen=True, slots=True, kw_only=True)
class TokensNotice:
    """A token is revoked."""

    type: Literal["tokens"] = "tokens"


@dataclass(frozen=True, slots=True, kw_only=True)
class EventsNotice:
    """Events are stored that a console is to see at once; 200 ids at most."""

    type: Literal["events"] = "events"
    ids: tuple[int, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class AcknowledgedNotice:
    """Others of a robot's alarms are acknowledged than before."""

    type: Literal["acknowledged"] = "acknowledged"
    robot: str


@dataclass(frozen=True, slots=True, kw_only=True)
class HandoverNotice:
    """Somebody has written a handover note."""

    type: Literal["handover"] = "handover"


@dataclass(frozen=True, slots=True, kw_only=True)
class IncidentNotice:
    """A robot has told of another incident."""

    type: Literal["incident"] = "incident"


@dataclass(frozen=True, slots=True, kw_only=True)
class RolloutNotice:
    """Something of a roll-out is new; `alert` is what people have to see of it."""

    type: Literal["rollout"] = "rollout"
    id: int
    alert: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class LoginNotice:
    """An attempt to log in counts as failed from its beginning on, until it is something else."""

    type: Literal["login"] = "login"
    step: Literal["begun", "cancelled", "succeeded"]
    name: str
    address: str
    browser: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class CodeNotice:
    """A one-time code counts as wrong from its attempt on, until it was right."""

    type: Literal["code"] = "code"
    step: Literal["begun", "succeeded"]
    name: str
    known_origin: str


@dataclass(frozen=True, slots=True, kw_only=True)
class StopRequestNotice:
    """A stop that cannot be stored: who has the robot's guard is to send it, and to say so."""

    type: Literal["stop"] = "stop"
    request: int
    robot: str
    actor: str
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class StopSentNotice:
    """The stop of a request is on its way to the guard."""

    type: Literal["stop_sent"] = "stop_sent"
    request: int


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandNotice:
    """A person's command, which who has the robot's guard is to send."""

    type: Literal["command"] = "command"
    robot: str
    command: Annotated[PersonCommand, Field(discriminator="type")]


@dataclass(frozen=True, slots=True, kw_only=True)
class ResponseNotice:
    """What a guard has answered to such a command."""

    type: Literal["command_response"] = "command_response"
    response: CommandResponse


Notice: TypeAlias = (
    SettingsNotice
    | TokensNotice
    | EventsNotice
    | AcknowledgedNotice
    | HandoverNotice
    | IncidentNotice
    | RolloutNotice
    | LoginNotice
    | CodeNotice
    | StopRequestNotice
    | StopSentNotice
    | CommandNotice
    | ResponseNotice
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Envelope:
    """A notice, and the replica that it is from; 0 for a program that is none.

    `number` is another one each time: of two payloads that are alike in one transaction PostgreSQL
    delivers one.
    """

    sender: int
    number: int
    notice: Annotated[Notice, Field(discriminator="type")]


_ENVELOPE: TypeAdapter[Envelope] = TypeAdapter(Envelope)
_numbers = count()


def notice_channel(session: Session) -> str:
    """Return the name of the channel."""
    return session.scalars(select(NoticeChannelRow.name)).one()


def post_notice(session: Session, notice: Notice) -> None:
    """Tell the other replicas once the session is committed."""
    post_notices(session, [notice])


def post_notices(session: Session, notices: Sequence[Notice]) -> None:
    """Tell the other replicas, in one statement, once the session is committed."""
    if not notices or session.get_bind().dialect.name == "sqlite":
        return
    sender = session.info.get(SENDER, 0)
    envelopes = [
        Envelope(sender=sender, number=next(_numbers), notice=notice) for notice in notices
    ]
    payloads = [_ENVELOPE.dump_json(each).decode() for each in envelopes]
    each = func.unnest(cast(payloads, ARRAY(Text))).column_valued("payload")
    session.execute(select(func.pg_notify(session.info[CHANNEL], each)))


def parse_notice(payload: str) -> Envelope:
    """Return what a payload says; ValueError if it is none of ours."""
    return _ENVELOPE.validate_json(payload)

"""The tables of the security service. Times are wall clock, integer ns since 1970.

The schema in a database is made by the migrations beside this file, never by these classes.
"""

from typing import Any

from sqlalchemy import (
    JSON,
    BigInteger,
    ForeignKey,
    Index,
    Integer,
    String,
    UniqueConstraint,
    text,
)
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column

# SQLite counts up by itself only in a column of type INTEGER.
_Long = BigInteger().with_variant(Integer, "sqlite")


def _partial_index(name: str, *columns: str, where: str) -> Index:
    condition = text(where)
    return Index(name, *columns, sqlite_where=condition, postgresql_where=condition)


class Table(DeclarativeBase):
    """Base of all tables."""

    type_annotation_map = {int: BigInteger, dict[str, Any]: JSON, list[str]: JSON}  # noqa: RUF012


class RobotRow(Table):
    """A robot, known since its guard first said hello, or since somebody named it."""

    __tablename__ = "robots"

    id: Mapped[int] = mapped_column(_Long, primary_key=True)
    name: Mapped[str] = mapped_column(String(100), unique=True)
    created: Mapped[int]
    seen: Mapped[int | None]
    app_id: Mapped[int | None]


class AppRow(Table):
    """An app on a robot under one plan; the newest hello names the current one."""

    __tablename__ = "apps"
    __table_args__ = (UniqueConstraint("robot_id", "name"),)

    id: Mapped[int] = mapped_column(_Long, primary_key=True)
    robot_id: Mapped[int] = mapped_column(ForeignKey("robots.id"))
    name: Mapped[str] = mapped_column(String(200))
    plan: Mapped[dict[str, Any]]
    digest: Mapped[str] = mapped_column(String(64))
    ros: Mapped[int]
    created: Mapped[int]
    changed: Mapped[int]


class GraphRow(Table):
    """The newest interaction graph of an app (`rtron.graph/1`), and its risks (`rtron.risks/2`)."""

    __tablename__ = "graphs"

    app_id: Mapped[int] = mapped_column(ForeignKey("apps.id"), primary_key=True)
    document: Mapped[dict[str, Any]]
    uploaded: Mapped[int]
    by: Mapped[str] = mapped_column(String(100))


class RiskRow(Table):
    """One risk of an app."""

    __tablename__ = "risks"

    app_id: Mapped[int] = mapped_column(ForeignKey("apps.id"), primary_key=True)
    risk: Mapped[str] = mapped_column(String(200), primary_key=True)
    position: Mapped[int]
    kind: Mapped[str] = mapped_column(String(20))
    severity: Mapped[str] = mapped_column(String(20))
    document: Mapped[dict[str, Any]]


class CoordinationNodeRow(Table):
    """The paper's risk model of one coordination node (section 6.3): metadata and policy settings.

    `triggered` is when it last refused or changed something, `violation` that event.
    """

    __tablename__ = "coordination_nodes"

    app_id: Mapped[int] = mapped_column(ForeignKey("apps.id"), primary_key=True)
    node: Mapped[str] = mapped_column(String(200), primary_key=True)
    position: Mapped[int]
    type: Mapped[str] = mapped_column(String(20))
    description: Mapped[str] = mapped_column(String(1000))
    risk_information: Mapped[dict[str, Any]]
    policy_settings: Mapped[dict[str, Any]]
    triggered: Mapped[int | None]
    violation: Mapped[dict[str, Any] | None]


class EventRow(Table):
    """An event of a guard; (`robot_id`, `run`, `number`) is stored once.

    `id` counts up in the order of storing and is never used again. `stored` is the service's
    clock, `at` the robot's. What is seldom has an index of its own.
    """

    __tablename__ = "events"
    __table_args__ = (
        UniqueConstraint("robot_id", "run", "number"),
        Index("events_by_robot", "robot_id", "id", "at"),
        Index("events_by_kind", "robot_id", "kind", "id"),
        _partial_index("events_of_note", "robot_id", "id", where="level <> 'info'"),
        _partial_index("events_without_counts", "robot_id", "id", where="kind <> 'counts'"),
        _partial_index("events_counts", "robot_id", "at", where="kind = 'counts'"),
        {"sqlite_autoincrement": True},
    )

    id: Mapped[int] = mapped_column(_Long, primary_key=True)
    robot_id: Mapped[int] = mapped_column(ForeignKey("robots.id"))
    run: Mapped[str] = mapped_column(String(40))
    number: Mapped[int]
    at: Mapped[int]
    stored: Mapped[int]
    kind: Mapped[str] = mapped_column(String(20))
    level: Mapped[str] = mapped_column(String(10))
    node: Mapped[str] = mapped_column(String(200))
    topic: Mapped[str] = mapped_column(String(300))
    flow: Mapped[str] = mapped_column(String(200))
    publisher: Mapped[str] = mapped_column(String(300))
    policy: Mapped[str] = mapped_column(String(30))
    decision: Mapped[str] = mapped_column(String(10))
    reason: Mapped[str] = mapped_column(String(1000))
    revision: Mapped[int]
    values: Mapped[dict[str, Any]]


class SettingsRow(Table):
    """The settings of an app at one revision; `outcome` is pending, applied, refused or replaced.

    `by`, `reason` and `at` are who made it; `outcome`, `error` and `answered` what the guard said.
    """

    __tablename__ = "settings"

    app_id: Mapped[int] = mapped_column(ForeignKey("apps.id"), primary_key=True)
    revision: Mapped[int] = mapped_column(primary_key=True)
    document: Mapped[dict[str, Any]]
    by: Mapped[str] = mapped_column(String(100))
    reason: Mapped[str] = mapped_column(String(1000))
    at: Mapped[int]
    outcome: Mapped[str] = mapped_column(String(10))
    error: Mapped[str] = mapped_column(String(1000))
    answered: Mapped[int | None]


class UserRow(Table):
    """Who may log in; the password is kept as its argon2 hash only."""

    __tablename__ = "users"

    id: Mapped[int] = mapped_column(_Long, primary_key=True)
    name: Mapped[str] = mapped_column(String(100), unique=True)
    password_hash: Mapped[str] = mapped_column(String(300))
    roles: Mapped[list[str]]
    disabled: Mapped[bool]
    created: Mapped[int]


class SessionRow(Table):
    """A login in a browser; its secret is kept as a hash only."""

    __tablename__ = "sessions"

    digest: Mapped[str] = mapped_column(String(64), primary_key=True)
    user_id: Mapped[int] = mapped_column(ForeignKey("users.id"), index=True)
    csrf: Mapped[str] = mapped_column(String(64))
    created: Mapped[int]
    used: Mapped[int]


class TokenRow(Table):
    """An API token of a program or a guard; its secret is kept as a hash only.

    A token with the scope `guard` speaks for one robot.
    """

    __tablename__ = "tokens"

    id: Mapped[int] = mapped_column(_Long, primary_key=True)
    name: Mapped[str] = mapped_column(String(100), unique=True)
    digest: Mapped[str] = mapped_column(String(64), unique=True)
    scopes: Mapped[list[str]]
    robot: Mapped[str] = mapped_column(String(100))
    by: Mapped[str] = mapped_column(String(100))
    created: Mapped[int]
    expires: Mapped[int | None]
    revoked: Mapped[int | None]
    used: Mapped[int | None]


class WebhookRow(Table):
    """Where alerts go: events of at least `level`, as JSON by POST, signed with `secret`."""

    __tablename__ = "webhooks"

    id: Mapped[int] = mapped_column(_Long, primary_key=True)
    url: Mapped[str] = mapped_column(String(1000))
    level: Mapped[str] = mapped_column(String(10))
    secret: Mapped[str] = mapped_column(String(100))
    created: Mapped[int]
    failing: Mapped[str] = mapped_column(String(300))


class AuditRow(Table):
    """Who did what, from where, and what came of it."""

    __tablename__ = "audit_log"

    id: Mapped[int] = mapped_column(_Long, primary_key=True)
    at: Mapped[int] = mapped_column(index=True)
    who: Mapped[str] = mapped_column(String(100))
    address: Mapped[str] = mapped_column(String(60))
    action: Mapped[str] = mapped_column(String(60))
    target: Mapped[str] = mapped_column(String(300))
    detail: Mapped[dict[str, Any]]
    outcome: Mapped[str] = mapped_column(String(300))

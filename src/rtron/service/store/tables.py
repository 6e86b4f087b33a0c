"""The tables of the security service. Times are wall clock, integer ns since 1970.

They make the schema of a new database. Migrations, which are frozen, bring an older one to it.
"""

from typing import Any

from sqlalchemy import (
    JSON,
    BigInteger,
    ForeignKey,
    Index,
    Integer,
    String,
    Text,
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


class RobotLabelRow(Table):
    """A label of a robot; the robots with one label are a group."""

    __tablename__ = "robot_labels"

    robot_id: Mapped[int] = mapped_column(ForeignKey("robots.id"), primary_key=True)
    label: Mapped[str] = mapped_column(String(100), primary_key=True, index=True)


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

    `id` counts up in the order of storing and is never used again; on PostgreSQL it says in which
    partition the event is, and `EventRunRow` that it is stored once. `stored` is the service's
    clock, `at` the robot's. What is seldom has an index of its own.
    """

    __tablename__ = "events"
    __table_args__ = (
        UniqueConstraint("robot_id", "run", "number").ddl_if(dialect="sqlite"),
        Index("events_by_number", "robot_id", "run", "number").ddl_if(dialect="postgresql"),
        Index("events_by_robot", "robot_id", "id", "at"),
        Index("events_by_kind", "robot_id", "kind", "id"),
        _partial_index("events_of_note", "robot_id", "id", where="level <> 'info'"),
        _partial_index("events_without_counts", "robot_id", "id", where="kind <> 'counts'"),
        _partial_index("events_counts", "robot_id", "at", where="kind = 'counts'"),
        {"sqlite_autoincrement": True, "postgresql_partition_by": "RANGE (id)"},
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


class EventRunRow(Table):
    """A run of a guard, and the highest number of its stored events; PostgreSQL's alone."""

    __tablename__ = "event_runs"

    robot_id: Mapped[int] = mapped_column(ForeignKey("robots.id"), primary_key=True)
    run: Mapped[str] = mapped_column(String(40), primary_key=True)
    number: Mapped[int]


class LiveGuardRow(Table):
    """A connected guard, the replica that it is connected to, and its state as JSON.

    PostgreSQL forgets it when it crashes (UNLOGGED), and SQLite's one process has it in memory.
    """

    __tablename__ = "live_guards"

    robot: Mapped[str] = mapped_column(String(100), primary_key=True)
    replica: Mapped[int]
    version: Mapped[int]
    dry_run: Mapped[bool]
    state: Mapped[str | None] = mapped_column(Text)


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
    """Who may log in; the password is kept as its argon2 hash only.

    `subject` is the digest of issuer and subject of who signs in at a provider.
    Of robots, a user may change those of `groups`; None: all.
    """

    __tablename__ = "users"
    __table_args__ = (Index("users_by_subject", "subject", unique=True),)

    id: Mapped[int] = mapped_column(_Long, primary_key=True)
    name: Mapped[str] = mapped_column(String(100), unique=True)
    password_hash: Mapped[str] = mapped_column(String(300))
    roles: Mapped[list[str]]
    disabled: Mapped[bool]
    created: Mapped[int]
    subject: Mapped[str | None] = mapped_column(String(64))
    groups: Mapped[list[str] | None] = mapped_column(JSON(none_as_null=True))


class SessionRow(Table):
    """A login in a browser; its secret is kept as a hash only. `stage`: what it waits for."""

    __tablename__ = "sessions"

    digest: Mapped[str] = mapped_column(String(64), primary_key=True)
    user_id: Mapped[int] = mapped_column(ForeignKey("users.id"), index=True)
    csrf: Mapped[str] = mapped_column(String(64))
    stage: Mapped[str] = mapped_column(String(10))
    created: Mapped[int]
    used: Mapped[int]


class KnownBrowserRow(Table):
    """A browser in which a user has logged in; its secret is kept as a hash only."""

    __tablename__ = "known_browsers"

    digest: Mapped[str] = mapped_column(String(64), primary_key=True)
    user_id: Mapped[int] = mapped_column(ForeignKey("users.id"), index=True)
    created: Mapped[int]


class SecondFactorRow(Table):
    """The key of a user's one-time codes, base 32; of steps up to `used_step` no code counts.

    It cannot be kept as a hash: the codes are computed of it.
    """

    __tablename__ = "second_factors"

    user_id: Mapped[int] = mapped_column(ForeignKey("users.id"), primary_key=True)
    key: Mapped[str] = mapped_column(String(64))
    is_confirmed: Mapped[bool]
    used_step: Mapped[int]
    created: Mapped[int]


class RecoveryCodeRow(Table):
    """A recovery code that was not used yet; it is kept as a hash only."""

    __tablename__ = "recovery_codes"

    digest: Mapped[str] = mapped_column(String(64), primary_key=True)
    user_id: Mapped[int] = mapped_column(ForeignKey("users.id"), index=True)


class TokenRow(Table):
    """An API token of a program or a guard; its secret is kept as a hash only.

    A token with the scope `guard` speaks for one robot. While it is renewed it has a second secret
    (`next_digest`), which replaces the first at its first use; that one is `previous_digest` then.
    `groups` are as of a user.
    """

    __tablename__ = "tokens"
    __table_args__ = (
        Index("tokens_by_next_digest", "next_digest", unique=True),
        Index("tokens_by_previous_digest", "previous_digest", unique=True),
    )

    id: Mapped[int] = mapped_column(_Long, primary_key=True)
    name: Mapped[str] = mapped_column(String(100), unique=True)
    digest: Mapped[str] = mapped_column(String(64), unique=True)
    scopes: Mapped[list[str]]
    robot: Mapped[str] = mapped_column(String(100))
    by: Mapped[str] = mapped_column(String(100))
    created: Mapped[int]
    expires: Mapped[int | None]
    lifetime: Mapped[int | None]
    next_digest: Mapped[str | None] = mapped_column(String(64))
    next_created: Mapped[int | None]
    previous_digest: Mapped[str | None] = mapped_column(String(64))
    revoked: Mapped[int | None]
    used: Mapped[int | None]
    groups: Mapped[list[str] | None] = mapped_column(JSON(none_as_null=True))


class PendingChangeRow(Table):
    """A change of users or tokens that waits for a second admin; `owner` is the person behind `by`.

    Secrets in it are hashes.
    """

    __tablename__ = "pending_changes"

    id: Mapped[int] = mapped_column(_Long, primary_key=True)
    change: Mapped[dict[str, Any]]
    by: Mapped[str] = mapped_column(String(100))
    owner: Mapped[str] = mapped_column(String(100))
    created: Mapped[int]
    expires: Mapped[int]


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


class AcknowledgementRow(Table):
    """Who has seen an alarm of a robot, which is `kind`, `topic`, `node` and `peer`, and a note.

    It ends (`ended`) when the guard tells of the alarm again: that it is over, or that it is back.
    """

    __tablename__ = "acknowledgements"
    __table_args__ = (
        _partial_index("acknowledgements_in_force", "robot_id", where="ended IS NULL"),
    )

    id: Mapped[int] = mapped_column(_Long, primary_key=True)
    robot_id: Mapped[int] = mapped_column(ForeignKey("robots.id"))
    kind: Mapped[str] = mapped_column(String(40))
    topic: Mapped[str] = mapped_column(String(300))
    node: Mapped[str] = mapped_column(String(300))
    peer: Mapped[str] = mapped_column(String(300))
    by: Mapped[str] = mapped_column(String(100))
    note: Mapped[str] = mapped_column(String(200))
    at: Mapped[int]
    ended: Mapped[int | None]


class HandoverRow(Table):
    """What one shift tells the next; `situation` counts what was so when it was written."""

    __tablename__ = "handovers"

    id: Mapped[int] = mapped_column(_Long, primary_key=True)
    at: Mapped[int]
    by: Mapped[str] = mapped_column(String(100))
    text: Mapped[str] = mapped_column(String(4000))
    situation: Mapped[dict[str, Any]]


class ChainRow(Table):
    """A hash chain by name, with its head; `anchor` is the signed statement of where it begins.

    Without an anchor it begins with its first entry.
    """

    __tablename__ = "chains"

    id: Mapped[int] = mapped_column(_Long, primary_key=True)
    name: Mapped[str] = mapped_column(String(120), unique=True)
    number: Mapped[int]
    hash: Mapped[str] = mapped_column(String(64))
    anchor: Mapped[dict[str, Any] | None] = mapped_column(JSON(none_as_null=True))


class ChainLinkRow(Table):
    """An entry's place in a chain; `entry_id` is that of its event, or of its line in the log."""

    __tablename__ = "chain_links"
    __table_args__ = ({"sqlite_with_rowid": False},)

    chain_id: Mapped[int] = mapped_column(ForeignKey("chains.id"), primary_key=True)
    number: Mapped[int] = mapped_column(primary_key=True)
    hash: Mapped[str] = mapped_column(String(64))
    entry_id: Mapped[int] = mapped_column(index=True)

"""The tables of roll-outs, as `store/tables.py` has the others."""

from typing import Any

from sqlalchemy import JSON, BigInteger, ForeignKey, Integer, String, Text, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from rtron.service.store.tables import Table

_Long = BigInteger().with_variant(Integer, "sqlite")


class PlanDocumentRow(Table):
    """A plan document that a roll-out brings to robots, by its SHA-256."""

    __tablename__ = "plan_documents"

    digest: Mapped[str] = mapped_column(String(64), primary_key=True)
    text: Mapped[str] = mapped_column(Text)


class RolloutRow(Table):
    """A change that goes out to robots in stages; `changed` is when `state` began.

    It is of settings (`nodes`), or the digest of another `plan`.
    """

    __tablename__ = "rollouts"

    id: Mapped[int] = mapped_column(
        BigInteger().with_variant(Integer(), "sqlite"), primary_key=True
    )
    by: Mapped[str] = mapped_column(String(100))
    reason: Mapped[str] = mapped_column(String(200))
    nodes: Mapped[dict[str, Any]]
    plan: Mapped[str | None] = mapped_column(String(64))
    policy: Mapped[dict[str, Any]]
    created: Mapped[int]
    changed: Mapped[int]
    state: Mapped[str] = mapped_column(String(10), index=True)
    note: Mapped[str] = mapped_column(String(1000))
    stage: Mapped[int]


class RolloutRobotRow(Table):
    """A robot of a roll-out, with what it was set to and showed before the change."""

    __tablename__ = "rollout_robots"
    __table_args__ = (UniqueConstraint("rollout_id", "position"),)

    rollout_id: Mapped[int] = mapped_column(ForeignKey("rollouts.id"), primary_key=True)
    robot_id: Mapped[int] = mapped_column(ForeignKey("robots.id"), primary_key=True, index=True)
    position: Mapped[int]
    phase: Mapped[str] = mapped_column(String(10))
    app_id: Mapped[int | None]
    before: Mapped[dict[str, Any] | None] = mapped_column(JSON(none_as_null=True))
    baseline: Mapped[dict[str, Any] | None] = mapped_column(JSON(none_as_null=True))
    event_id: Mapped[int | None]
    run: Mapped[str | None] = mapped_column(String(40))
    revision: Mapped[int | None]
    sent_at: Mapped[int | None]
    missing_since: Mapped[int | None]
    problems: Mapped[list[str]]
    note: Mapped[str] = mapped_column(String(300))

"""Which guards are connected to which replica, and what they are at: a table of PostgreSQL.

A row belongs to the replica that the guard connected to last. It counts while that replica lives,
which its lock says: PostgreSQL ends the lock with the connection, however the replica ends.
"""

import json
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

from sqlalchemy import BigInteger, Connection, cast, column, delete, func, select, table, text
from sqlalchemy.orm import Session

from rtron.service.store.tables import LiveGuardRow

_LOCK_CLASS = 0x5254726F
"""The first half of the advisory locks of replicas ("RTro"); the second is the replica."""
_LOCKS = table("pg_locks", *map(column, ("locktype", "database", "classid", "objid", "objsubid")))
_DATABASES = table("pg_database", column("oid"), column("datname"))
_OWN_DATABASE = select(_DATABASES.c.oid).where(_DATABASES.c.datname == func.current_database())
_LIVING = select(cast(_LOCKS.c.objid, BigInteger)).where(
    _LOCKS.c.locktype == "advisory",
    _LOCKS.c.classid == _LOCK_CLASS,
    _LOCKS.c.objsubid == 2,  # noqa: PLR2004 - of a lock with two halves
    _LOCKS.c.database == _OWN_DATABASE.scalar_subquery(),
)
_KEEPALIVE = {"tcp_keepalives_idle": 2, "tcp_keepalives_interval": 1, "tcp_keepalives_count": 3}
# Rows are one parameter, JSON: the driver would take apart an array letter by letter.
_CLAIM = text("""INSERT INTO live_guards (robot, replica, version, dry_run, state)
    SELECT robot, :replica, 0, dry_run, NULL
    FROM json_to_recordset(CAST(:rows AS json)) AS new(robot text, dry_run boolean) ORDER BY robot
    ON CONFLICT (robot) DO UPDATE SET replica = excluded.replica, dry_run = excluded.dry_run,
    version = live_guards.version + 1, state = NULL""")
_STORE_STATES = text("""UPDATE live_guards SET state = new.state, version = version + 1
    FROM json_to_recordset(CAST(:rows AS json)) AS new(robot text, state text)
    WHERE live_guards.robot = new.robot AND live_guards.replica = :replica""")
_NO_OBJECTS = {"synchronize_session": False}


@dataclass(frozen=True, slots=True, kw_only=True)
class LiveGuard:
    """A connected guard: `state` is JSON, None until it has told one; `version` grows with it."""

    robot: str
    replica: int
    version: int
    dry_run: bool
    state: str | None


def lock_replica(connection: Connection, replica: int) -> None:
    """Let a replica live as long as this connection does; one that hangs does so for 5 s."""
    for name, seconds in _KEEPALIVE.items():
        connection.exec_driver_sql(f"SET {name} = {seconds:d}")
    lock = text("SELECT pg_advisory_lock_shared(:kind, :replica)")
    connection.execute(lock, {"kind": _LOCK_CLASS, "replica": replica})


def claim_guards(session: Session, replica: int, guards: Mapping[str, bool]) -> None:
    """Let these guards belong to a replica: robots, and whether each guard forbids nothing."""
    if guards:
        rows = [{"robot": robot, "dry_run": dry_run} for robot, dry_run in guards.items()]
        session.execute(_CLAIM, {"rows": json.dumps(rows), "replica": replica})


def store_states(session: Session, replica: int, states: Mapping[str, str]) -> None:
    """Store what guards are at, JSON, those that belong to the replica."""
    if states:
        rows = ",".join(f'{{"robot":"{robot}","state":{state}}}' for robot, state in states.items())
        session.execute(_STORE_STATES, {"rows": f"[{rows}]", "replica": replica})


def release_guards(session: Session, replica: int, robots: Collection[str]) -> None:
    """Note that guards have gone, unless they have connected to another replica."""
    if robots:
        is_own = LiveGuardRow.replica == replica, LiveGuardRow.robot.in_(sorted(robots))
        session.execute(delete(LiveGuardRow).where(*is_own), execution_options=_NO_OBJECTS)


def guard_owners(session: Session, robots: Collection[str]) -> Mapping[str, int]:
    """Return the replica that each guard belongs to, living or not."""
    query = select(LiveGuardRow.robot, LiveGuardRow.replica)
    rows = session.execute(query.where(LiveGuardRow.robot.in_(robots)))
    return {robot: owner for robot, owner in rows}  # noqa: C416 - rows are no pairs for mypy


def live_versions(session: Session) -> Mapping[str, tuple[int, int]]:
    """Return all connected guards: the replica of each, and the version of its state."""
    query = select(LiveGuardRow.robot, LiveGuardRow.replica, LiveGuardRow.version)
    rows = session.execute(query.where(LiveGuardRow.replica.in_(_LIVING)))
    return {robot: (replica, version) for robot, replica, version in rows}


def live_guards(session: Session, robots: Collection[str]) -> Sequence[LiveGuard]:
    """Return those of the robots whose guards are connected."""
    is_chosen = LiveGuardRow.robot.in_(robots), LiveGuardRow.replica.in_(_LIVING)
    rows = session.scalars(select(LiveGuardRow).where(*is_chosen))
    return [
        LiveGuard(
            robot=row.robot,
            replica=row.replica,
            version=row.version,
            dry_run=row.dry_run,
            state=row.state,
        )
        for row in rows
    ]


def delete_orphans(session: Session) -> None:
    """Delete what replicas have left that live no more."""
    is_orphan = LiveGuardRow.replica.not_in(_LIVING)
    session.execute(delete(LiveGuardRow).where(is_orphan), execution_options=_NO_OBJECTS)

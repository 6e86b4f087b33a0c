"""Whether the audit log, the settings and the events are what their chains say they were."""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from sqlalchemy import Row, Select, func, select
from sqlalchemy.orm import Session

from rtron.service.domain.hash_chain import ChainReport, Head, Link, Witness, anchor_of, check_chain
from rtron.service.store.audit import AUDIT_CONTENT, audit_content
from rtron.service.store.chains import EVENTS_PREFIX
from rtron.service.store.database import Database
from rtron.service.store.events import EVENT_CONTENT, event_content
from rtron.service.store.settings import SETTINGS_KEY, settings_digest
from rtron.service.store.tables import (
    AppRow,
    AuditRow,
    ChainLinkRow,
    ChainRow,
    EventRow,
    RobotRow,
    SettingsRow,
)
from rtron.vocabulary import EventKind

_MAX_LISTED = 5


@dataclass(frozen=True, slots=True)
class DatabaseReport:
    """What a check of the whole database found: chain by chain, and what is in no chain."""

    chains: Sequence[ChainReport]
    faults: Sequence[str]

    @property
    def is_whole(self) -> bool:
        """Whether there are no faults."""
        return not self.faults and not any(chain.faults for chain in self.chains)


@dataclass(slots=True)
class _SettingsDigests:
    """The digests of settings that the chains have, by robot, app and revision."""

    found: dict[tuple[str, str, int], str] = field(default_factory=dict)

    def watch(self, links: Iterable[Link]) -> Iterator[Link]:
        """Yield links, and keep the digests that are in them."""
        for link in links:
            made = link.content["detail"].get(SETTINGS_KEY) if link.content else None
            if link.content and isinstance(made, dict):
                robot = link.content["target"].partition("/")[0]
                self.found[robot, made["app"], made["revision"]] = made["sha256"]
            yield link


def check_database(
    session: Session, witnesses: Mapping[str, Sequence[Witness]], keys: Collection[str]
) -> DatabaseReport:
    """Check everything in one state of the database; `keys` (hex) may sign where chains begin."""
    digests = _SettingsDigests()
    chains = all_chains(session)
    reports = [
        _check_chain(session, chain, witnesses.get(chain.name, ()), keys, digests)
        for chain in chains
    ]
    gone = sorted(witnesses.keys() - {chain.name for chain in chains})
    faults = [
        f"the chain {name} is gone, but in a head {_newest(witnesses[name])}" for name in gone
    ]
    faults += _unlinked_faults(session, chains)
    faults += _settings_faults(session, digests.found)
    return DatabaseReport(reports, faults)


def _check_chain(
    session: Session,
    chain: ChainRow,
    witnesses: Sequence[Witness],
    keys: Collection[str],
    digests: _SettingsDigests,
) -> ChainReport:
    begin, fault = anchor_of(chain.anchor, keys, chain.name)
    links = chain_links(session, chain)
    if not chain.name.startswith(EVENTS_PREFIX):
        links = digests.watch(links)
    report = check_chain(chain.name, begin, links, Head(chain.number, chain.hash), witnesses)
    if fault:
        report.add(fault)
    return report


def _newest(witnesses: Sequence[Witness]) -> str:
    return max(witnesses, key=lambda each: each.head.number).source


def _unlinked_faults(session: Session, chains: Sequence[ChainRow]) -> Iterator[str]:
    """Yield what stands in the log or among the events, and in no chain."""
    is_of_events = ChainRow.name.startswith(EVENTS_PREFIX)
    linked = select(ChainLinkRow.entry_id).join(ChainRow, ChainRow.id == ChainLinkRow.chain_id)
    yield from _unlinked(session, "line", select(AuditRow.id), linked.where(~is_of_events))
    linked = linked.where(is_of_events)
    events = select(EventRow.id).where(EventRow.kind != EventKind.COUNTS.value)
    if not any(chain.anchor for chain in chains):  # those of before the chains may be there still
        first = select(func.min(linked.subquery().c.entry_id)).scalar_subquery()
        events = events.where((EventRow.id > first) | (EventRow.id < 1))
    yield from _unlinked(session, "event", events, linked)


def _unlinked(session: Session, what: str, rows: Select[Any], linked: Select[Any]) -> Iterator[str]:
    query = rows.except_(linked)
    ids = sorted(session.scalars(query))
    if ids:
        listed = ", ".join(map(str, ids[:_MAX_LISTED])) + (", …" if len(ids) > _MAX_LISTED else "")
        yield f"{len(ids)} {what}(s) are in no chain: somebody has put them in: {listed}"


def _settings_faults(
    session: Session, digests: Mapping[tuple[str, str, int], str]
) -> Iterator[str]:
    """Yield settings that are not what the log says; older ones than the chain are left out."""
    first: dict[tuple[str, str], int] = {}
    for robot, app, revision in digests:
        first[robot, app] = min(revision, first.get((robot, app), revision))
    found = set()
    for robot, app, row in _settings_rows(session):
        key = robot, app, row.revision
        found.add(key)
        is_older = row.revision < first.get((robot, app), row.revision + 1)
        if not is_older and digests.get(key) != settings_digest(app, row):
            yield f"the settings of {robot} ({app}) at revision {row.revision} are not those logged"
    for robot, app, revision in sorted(digests.keys() - found):
        yield f"the settings of {robot} ({app}) at revision {revision} are gone"


def _settings_rows(session: Session) -> Iterator[tuple[str, str, SettingsRow]]:
    query = (
        select(RobotRow.name, AppRow.name, SettingsRow)
        .join_from(SettingsRow, AppRow, AppRow.id == SettingsRow.app_id)
        .join(RobotRow, RobotRow.id == AppRow.robot_id)
        .order_by(SettingsRow.app_id, SettingsRow.revision)
    )
    rows = session.execute(query).yield_per(1000)
    yield from ((robot, app, row) for robot, app, row in rows)


_PAGE = 1000


@contextmanager
def snapshot(database: Database) -> Iterator[Session]:
    """Give a transaction that sees one state of the database, and writes nothing."""
    with Session(database.engine) as session:
        if database.is_sqlite:
            session.connection().exec_driver_sql("BEGIN")
        else:
            session.connection(execution_options={"isolation_level": "REPEATABLE READ"})
        yield session


def all_chains(session: Session) -> list[ChainRow]:
    """Return every chain, by name."""
    return list(session.scalars(select(ChainRow).order_by(ChainRow.name)))


def chain_links(
    session: Session, chain: ChainRow, after: int | None = None, end_id: int | None = None
) -> Iterator[Link]:
    """Yield the entries of a chain in their order, all of them unless told otherwise.

    Those behind a number, and of rows before an id.
    """
    query = _events_query() if chain.name.startswith(EVENTS_PREFIX) else _audit_query()
    query = query.where(ChainLinkRow.chain_id == chain.id).order_by(ChainLinkRow.number)
    if end_id is not None:
        query = query.where(ChainLinkRow.entry_id < end_id)
    if after is not None:
        query = query.where(ChainLinkRow.number > after)
    page = query.limit(_PAGE)
    while rows := session.execute(page).all():
        yield from (_link(row) for row in rows)
        page = query.where(ChainLinkRow.number > rows[-1].link_number).limit(_PAGE)


def _audit_query() -> Select[Any]:
    columns = [getattr(AuditRow, name) for name in AUDIT_CONTENT]
    return select(*_link_columns(AuditRow.id), *columns).outerjoin(
        AuditRow, AuditRow.id == ChainLinkRow.entry_id
    )


def _events_query() -> Select[Any]:
    columns = [getattr(EventRow, name) for name in EVENT_CONTENT]
    return (
        select(*_link_columns(EventRow.id), RobotRow.name.label("robot"), *columns)
        .outerjoin(EventRow, EventRow.id == ChainLinkRow.entry_id)
        .outerjoin(RobotRow, RobotRow.id == EventRow.robot_id)
    )


def _link_columns(entry_id: Any) -> list[Any]:  # noqa: ANN401 - a column
    link = ChainLinkRow
    return [link.number.label("link_number"), link.hash.label("link_hash"), entry_id.label("found")]


def _link(row: Row[Any]) -> Link:
    if row.found is None:
        return Link(row.link_number, row.link_hash, None)
    is_event = "robot" in row._fields
    content = event_content(row.robot, row._asdict()) if is_event else audit_content(row)
    return Link(row.link_number, row.link_hash, content)

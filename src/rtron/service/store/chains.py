"""The chains of the audit log and of what guards report: appended to, cut at the beginning.

A link is written in the transaction of its entry. Whoever appends has the chain's row locked until
the end of the transaction, so no two entries follow the same one.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import Row, Table, insert, select
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.orm import Session

from rtron.service.domain.hash_chain import GENESIS, Content, Head, next_head
from rtron.service.store.tables import ChainLinkRow, ChainRow

SERVICE_CHAIN = "service"
"""The chain of what people do that is about no robot: logins, users, tokens, webhooks."""
EVENTS_PREFIX = "events:"
_ROBOT_PREFIX = "robot:"

_CHAINS: Table = ChainRow.__table__  # type: ignore[assignment]  # a table, not a join
_LINKS: Table = ChainLinkRow.__table__  # type: ignore[assignment]  # likewise


def audit_chain(robot: str) -> str:
    """Return the chain of what is done to a robot, or, without a robot, to the service."""
    return _ROBOT_PREFIX + robot if robot else SERVICE_CHAIN


def events_chain(robot: str) -> str:
    """Return the chain of what the guard of a robot reports."""
    return EVENTS_PREFIX + robot


@dataclass(frozen=True, slots=True)
class ChainEntry:
    """An entry that is stored: its chain, the id of its row, and what the chain has of it."""

    chain: str
    row_id: int
    content: Content


def append_entries(session: Session, entries: Sequence[ChainEntry]) -> None:
    """Append entries to their chains, in this order; the rows they are of are written before.

    With SQLite that write has the database's lock already.
    """
    if not entries:
        return
    rows = _locked_chains(session, sorted({entry.chain for entry in entries}))
    heads = {name: Head(row.number, row.hash) for name, row in rows.items()}
    links = []
    for entry in entries:
        head = heads[entry.chain] = next_head(entry.chain, heads[entry.chain], entry.content)
        link = {"chain_id": rows[entry.chain].id, "number": head.number, "hash": head.hash}
        links.append({**link, "entry_id": entry.row_id})
    session.execute(insert(_LINKS), links)
    _store_heads(session, heads)


def chain_heads(session: Session) -> Mapping[str, Head]:
    """Return the head of every chain, by name."""
    query = select(_CHAINS.c.name, _CHAINS.c.number, _CHAINS.c.hash).order_by(_CHAINS.c.name)
    return {name: Head(number, hash) for name, number, hash in session.execute(query)}


def lock_chains(session: Session, names: Sequence[str]) -> dict[str, Row[Any]]:
    """Return these chains, as far as they are there, locked in one order for all: their names'."""
    columns = [_CHAINS.c.id, _CHAINS.c.name, _CHAINS.c.number, _CHAINS.c.hash, _CHAINS.c.anchor]
    query = select(*columns).where(_CHAINS.c.name.in_(names)).order_by(_CHAINS.c.name)
    return {row.name: row for row in session.execute(query.with_for_update())}


def store_anchors(session: Session, anchors: Mapping[str, Mapping[str, Any]]) -> None:
    """Store the signed statements of where chains begin."""
    values = [{**_new_chain(name), "anchor": anchor} for name, anchor in anchors.items()]
    _update(session, ("anchor",), values)


def _locked_chains(session: Session, names: Sequence[str]) -> dict[str, Row[Any]]:
    """Return these chains, locked; made where they are new."""
    rows = lock_chains(session, names)
    if len(rows) < len(names):
        new = [_new_chain(name) for name in names if name not in rows]
        session.execute(_insert(session).on_conflict_do_nothing(), new)
        rows = lock_chains(session, names)
    return rows


def _new_chain(name: str) -> dict[str, Any]:
    return {"name": name, "number": GENESIS.number, "hash": GENESIS.hash, "anchor": None}


def _store_heads(session: Session, heads: Mapping[str, Head]) -> None:
    values = [
        {**_new_chain(name), "number": head.number, "hash": head.hash}
        for name, head in heads.items()
    ]
    _update(session, ("number", "hash"), values)


def _update(session: Session, columns: Sequence[str], values: Sequence[Mapping[str, Any]]) -> None:
    """Change columns of chains that are there, for PostgreSQL in one statement."""
    change = _insert(session)
    new = {name: change.excluded[name] for name in columns}
    change = change.on_conflict_do_update(index_elements=[_CHAINS.c.name], set_=new)
    session.execute(change.returning(_CHAINS.c.id), values)


def _insert(session: Session) -> Any:  # noqa: ANN401 - of either dialect, with the same methods
    if session.get_bind().dialect.name == "sqlite":
        return sqlite.insert(_CHAINS)
    return postgresql.insert(_CHAINS)

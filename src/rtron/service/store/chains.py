"""The chains of the audit log and of what guards report: appended to, cut at the beginning.

A link is written in the transaction of its entry. Whoever appends has the chain's row locked until
the end of the transaction, so no two entries follow the same one.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import Row, Table, insert, select, tuple_
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.orm import Session

from rtron.service.domain.hash_chain import GENESIS, Content, Head, anchor_of, next_head
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


_PAGE = 500
HeldHeads = Mapping[str, Collection[Head]]
"""Heads by the names of their chains."""


def contradicted_heads(session: Session, heads: HeldHeads) -> Iterator[tuple[str, Head, str]]:
    """Yield each head that is not in its chain now: the chain, the head, and why.

    What the retention has deleted since is no reason. By whom a chain's begin is signed, another
    replica perhaps, is not asked here.
    """
    query = select(ChainRow).where(ChainRow.name.in_(heads))
    chains = {chain.name: chain for chain in session.scalars(query)}
    hashes = _stored_hashes(session, chains.values(), heads)
    for name, several in heads.items():
        for head in several:
            if reason := _contradiction(chains.get(name), head, hashes):
                yield name, head, reason


def _stored_hashes(
    session: Session, chains: Iterable[ChainRow], heads: HeldHeads
) -> dict[tuple[int, int], str]:
    """Return the hashes that are stored at the places of heads, by chain and number."""
    places = [
        (chain.id, head.number)
        for chain in chains
        for head in heads[chain.name]
        if head.number <= chain.number
    ]
    link = ChainLinkRow
    query = select(link.chain_id, link.number, link.hash)
    found: dict[tuple[int, int], str] = {}
    for first in range(0, len(places), _PAGE):
        page = places[first : first + _PAGE]
        for row in session.execute(query.where(tuple_(link.chain_id, link.number).in_(page))):
            found[row.chain_id, row.number] = row.hash
    return found


def _contradiction(
    chain: ChainRow | None, head: Head, hashes: Mapping[tuple[int, int], str]
) -> str:
    if chain is None:
        return "the chain is gone"
    if head.number > chain.number:
        return f"entries {chain.number + 1} to {head.number} are missing"
    stored = hashes.get((chain.id, head.number))
    if stored is not None:
        return "" if stored == head.hash else f"entry {head.number}, or one before it, was another"
    key = str((chain.anchor or {}).get("key"))
    begin, fault = anchor_of(chain.anchor, [key], chain.name)
    if head.number < begin.number or head == begin:
        return ""
    return fault or f"entry {head.number} is missing"

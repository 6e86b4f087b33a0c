"""Heads that were signed before and kept elsewhere, compared with the chains as they are now."""

from collections.abc import Collection, Iterable, Iterator, Mapping

from sqlalchemy import select, tuple_
from sqlalchemy.orm import Session

from rtron.service.domain.hash_chain import Head
from rtron.service.domain.signed_documents import anchor_of
from rtron.service.store.tables import ChainLinkRow, ChainRow

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

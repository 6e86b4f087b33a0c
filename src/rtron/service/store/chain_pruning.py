"""Retention and the chains of events: a signature says where a chain begins now, and that it may.

The anchor of a chain says behind which entry it begins. It is signed only behind an anchor that is
signed, too, and over entries that were checked just before: nobody can change or delete what is old
and let the retention hide it. A chain of which that is not so is refused, and stays as it is.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from sqlalchemy import Row, delete, select
from sqlalchemy.orm import Session

from rtron.service.domain.clock import Clock
from rtron.service.domain.hash_chain import DocumentSigner, Head, Link, anchor_of, link_faults
from rtron.service.store.chains import EVENTS_PREFIX, lock_chains, store_anchors
from rtron.service.store.events import EVENT_CONTENT, event_content
from rtron.service.store.tables import ChainLinkRow, ChainRow, EventRow, RobotRow

LinksBehind = Callable[[Head], Iterable[Link]]
"""Returns the oldest entries of a chain, those behind where it begins."""

_NO_OBJECTS = {"synchronize_session": False}


@dataclass(frozen=True, slots=True)
class ChainBegin:
    """Where a chain begins, the head up to which entries fit it, and what is wrong behind that."""

    before: Head
    head: Head
    fault: str = ""

    @property
    def fitting_entries(self) -> int:
        """How many entries fit."""
        return self.head.number - self.before.number


class ChainCutter:
    """Finds and signs where chains may begin; `refused` says what is wrong with other chains.

    What it refuses stays in there until it finds it in order.
    """

    def __init__(self, signer: DocumentSigner, clock: Clock) -> None:
        self._signer, self._clock = signer, clock
        self.refused: dict[str, str] = {}

    def check(self, chain: ChainRow | Row[Any], links: LinksBehind) -> ChainBegin:
        """Return how far the oldest entries of a chain fit it, behind its signed beginning."""
        before, fault = anchor_of(chain.anchor, self._signer.trusted_keys, chain.name)
        begin = ChainBegin(before, before, fault)
        if not fault:
            begin = _check(chain.name, before, links(before))
        if begin.fault:
            self.refused[chain.name] = begin.fault
        else:
            self.refused.pop(chain.name, None)
        return begin

    def store(self, session: Session, begins: Mapping[str, ChainBegin]) -> None:
        """Let chains begin behind what fits of them."""
        now = self._clock()
        anchors = {
            name: self._signer.sign_anchor(now, name, begin.head)
            for name, begin in begins.items()
            if begin.fitting_entries
        }
        if anchors:
            store_anchors(session, anchors)


def cut_chains(
    session: Session, event_ids: Sequence[int], cutter: ChainCutter
) -> Mapping[int, int]:
    """Let the chains of these events begin behind them, as far as they fit; forget their links.

    Return the events that do not fit, with the ids of their robots.
    """
    rows = session.execute(_query(event_ids)).all()
    chains = lock_chains(session, sorted({row.chain for row in rows}))
    begins: dict[str, ChainBegin] = {}
    fitting: list[int] = []
    refused: dict[int, int] = {}
    for name, group in groupby(rows, lambda row: row.chain):
        of_chain = list(group)
        begins[name] = cutter.check(chains[name], _links_of(of_chain))
        count = begins[name].fitting_entries
        fitting += [row.id for row in of_chain[:count]]
        refused |= {row.id: row.robot_id for row in of_chain[count:]}
    cutter.store(session, begins)
    ids = [chain.id for chain in chains.values()]
    links = delete(ChainLinkRow).where(
        ChainLinkRow.entry_id.in_(fitting), ChainLinkRow.chain_id.in_(ids)
    )
    session.execute(links, execution_options=_NO_OBJECTS)
    return refused


def _check(chain: str, before: Head, links: Iterable[Link]) -> ChainBegin:
    head = before
    for link in links:
        for fault in link_faults(chain, head, link):
            return ChainBegin(before, head, fault)
        head = Head(link.number, link.hash)
    return ChainBegin(before, head)


def _query(event_ids: Sequence[int]) -> Any:  # noqa: ANN401 - a long type of SQLAlchemy's
    columns = [getattr(EventRow, name) for name in EVENT_CONTENT]
    link = ChainLinkRow
    return (
        select(
            EventRow.id,
            EventRow.robot_id,
            ChainRow.name.label("chain"),
            link.number.label("link_number"),
            link.hash.label("link_hash"),
            RobotRow.name.label("robot"),
            *columns,
        )
        .join_from(link, ChainRow, ChainRow.id == link.chain_id)
        .join(EventRow, EventRow.id == link.entry_id)
        .join(RobotRow, RobotRow.id == EventRow.robot_id)
        .where(link.entry_id.in_(event_ids), ChainRow.name.startswith(EVENTS_PREFIX))
        .order_by(ChainRow.name, link.number)
    )


def _links_of(rows: Sequence[Row[Any]]) -> LinksBehind:
    """Return the links of rows, wherever their chain is said to begin."""
    return lambda _begin: map(_link, rows)


def _link(row: Row[Any]) -> Link:
    return Link(row.link_number, row.link_hash, event_content(row.robot, row._asdict()))

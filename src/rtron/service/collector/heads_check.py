"""Heads of the log that a guard brings, compared with the log: they show a log that was changed.

A guard that was away has heads which nobody could take back. What differs is an alarm of its robot,
an event that alerts are sent for, and a line of the audit log.
"""

import logging
from collections.abc import Mapping, Sequence
from typing import Any

from sqlalchemy.exc import SQLAlchemyError

from rtron.errors import WireError
from rtron.service.collector.log_faults import LogFault
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.clock import Clock
from rtron.service.domain.hash_chain import (
    HEADS_SCHEMA,
    DocumentSigner,
    Head,
    heads_of,
    verify_document,
)
from rtron.service.store.audit import record_repeatable
from rtron.service.store.chains import SERVICE_CHAIN, audit_chain, contradicted_heads, events_chain
from rtron.service.store.database import Database

log = logging.getLogger(__name__)

Document = Mapping[str, Any]
Documents = Sequence[Document]


class HeadsCheck:
    """Compares heads that guards bring with the log; from any thread."""

    def __init__(self, database: Database, signer: DocumentSigner, clock: Clock) -> None:
        self._database, self._signer, self._clock = database, signer, clock

    def check(self, robot: str, documents: Documents) -> Sequence[LogFault]:
        """Return the oldest head of each chain that is not in the log, and write it down there."""
        try:
            found = self._find(robot, documents)
            if found:
                self._record(robot, found)
        except SQLAlchemyError as error:
            log.error("the heads of %s are not compared: %s", robot, type(error).__name__)  # noqa: TRY400
            return ()
        return found

    def _find(self, robot: str, documents: Documents) -> list[LogFault]:
        sources: dict[tuple[str, Head], Document] = {}
        for document in documents:
            for chain, head in _heads(robot, document).items():
                sources[chain, head] = document
        heads: dict[str, list[Head]] = {}
        for chain, head in sorted(sources, key=lambda each: each[1].number):
            heads.setdefault(chain, []).append(head)
        with self._database.session() as session:
            differing = list(contradicted_heads(session, heads))
        oldest: dict[str, LogFault] = {}
        for chain, head, reason in differing:
            origin = self._origin(sources[chain, head])
            fault = LogFault(chain, f"{reason}{origin}", head.hash, head.number)
            oldest.setdefault(chain, fault)
        return list(oldest.values())

    def _origin(self, document: Document) -> str:
        """Return what is odd about a document; a service that was set up anew has another key."""
        try:
            verify_document(document, self._signer.trusted_keys, HEADS_SCHEMA)
        except WireError as error:
            return f" (as a head tells, but {error})"
        return ""

    def _record(self, robot: str, found: Sequence[LogFault]) -> None:
        with self._database.write_session() as session:
            for each in found:
                log.error("%s has a head of before: %s", robot, each.alarm.reason)
                detail = {"revision": each.number, "chain": each.chain}
                event = AuditEvent(
                    who=f"guard:{robot}", action="heads", target=robot, detail=detail
                )
                record_repeatable(session, self._clock(), event, f"refused: {each.reason}")


def _heads(robot: str, document: Document) -> Mapping[str, Head]:
    """Return the heads of the robot's chains in a document; a guard may bring anything."""
    names = {SERVICE_CHAIN, audit_chain(robot), events_chain(robot)}
    try:
        heads = heads_of(document)
    except WireError as error:
        log.warning("heads that %s keeps cannot be compared: %s", robot, error)
        return {}
    return {name: head for name, head in heads.items() if name in names and head.number > 0}

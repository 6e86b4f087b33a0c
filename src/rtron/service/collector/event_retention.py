"""Old events are deleted, again and again; a chain whose beginning somebody changed is an alarm."""

import asyncio
import hashlib
import logging
from collections.abc import Callable, Mapping, Sequence
from functools import partial

from sqlalchemy.exc import SQLAlchemyError

from rtron.service.collector.event_writer import EventWriter, QueuedBatch
from rtron.service.collector.log_faults import LogFault
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.clock import Clock
from rtron.service.domain.hash_chain import DocumentSigner
from rtron.service.store.audit import record_repeatable
from rtron.service.store.chain_pruning import ChainCutter
from rtron.service.store.chains import EVENTS_PREFIX
from rtron.service.store.database import Database
from rtron.service.store.events import EventBatch
from rtron.service.store.incidents import prune_incidents
from rtron.service.store.retention import RetentionLimits, prune_events
from rtron.service.store.robots import find_robot

log = logging.getLogger(__name__)

_INTERVAL_S = 60.0
_PAUSE_S = 0.01
_MAX_LISTED = 5
_SHARE = 4
"""Incidents take one in so many bytes of what is allowed for events."""


class EventRetention:
    """Deletes what is out of bounds, once a minute while it runs."""

    def __init__(
        self,
        database: Database,
        limits: RetentionLimits,
        signer: DocumentSigner,
        clock: Clock,
        *,
        event_writer: EventWriter,
        on_deleted: Callable[[int], None],
    ) -> None:
        """Store alarms with `event_writer`; call `on_deleted` with how many went."""
        self._database, self._limits, self._clock = database, limits, clock
        self._event_writer, self._on_deleted = event_writer, on_deleted
        self._cutter = ChainCutter(signer, clock)
        self._reported: dict[str, LogFault] = {}

    async def run(self) -> None:
        """Delete, until it is cancelled."""
        while True:
            try:
                await self.prune()
            except SQLAlchemyError as error:
                log.error("old events are not deleted: %s", type(error).__name__)  # noqa: TRY400
            await asyncio.sleep(_INTERVAL_S)

    async def prune(self) -> None:
        """Delete what is out of bounds now; what does not fit its chain is told once."""
        slices = prune_events(self._database, self._limits, self._clock(), self._cutter)
        while (deleted := await asyncio.to_thread(next, slices, None)) is not None:
            self._on_deleted(deleted)
            await asyncio.sleep(_PAUSE_S)
        await asyncio.to_thread(self._prune_incidents)
        refused = dict(self._cutter.refused)
        if refused:
            listed = ", ".join(sorted(refused)[:_MAX_LISTED])
            log.error("old events do not fit their chains, see `rtron audit verify`: %s", listed)
        new = [LogFault(chain, fault, _key(fault)) for chain, fault in refused.items()]
        await self._report([fault for fault in new if self._reported.get(fault.chain) != fault])

    def _prune_incidents(self) -> None:
        cutoff = self._clock() - self._limits.max_age
        with self._database.write_session() as session:
            prune_incidents(session, cutoff, self._limits.max_bytes // _SHARE)

    async def _report(self, faults: Sequence[LogFault]) -> None:
        """Write faults down, each an alarm of its robot; what cannot be stored comes again."""
        if not faults:
            return
        batches = await asyncio.to_thread(self._record, faults)
        for fault in faults:
            if fault not in batches:
                self._reported[fault.chain] = fault
        for fault, batch in batches.items():
            await self._event_writer.put(QueuedBatch(batch, 0, partial(self._note_reported, fault)))

    def _record(self, faults: Sequence[LogFault]) -> Mapping[LogFault, EventBatch]:
        """Write a line about each fault into the audit log; return the events of known robots."""
        batches: dict[LogFault, EventBatch] = {}
        now = self._clock()
        with self._database.write_session() as session:
            for fault in faults:
                robot = fault.chain.removeprefix(EVENTS_PREFIX)
                detail = {"chain": fault.chain}
                event = AuditEvent(who="rtron", action="retention", target=robot, detail=detail)
                record_repeatable(session, now, event, f"refused: {fault.reason}")
                if found := find_robot(session, robot):
                    batches[fault] = EventBatch(found[0].id, robot, [fault.event(now)])
        return batches

    def _note_reported(self, fault: LogFault, is_stored: bool) -> None:  # noqa: FBT001 - the answer
        if is_stored:
            self._reported[fault.chain] = fault


def _key(fault: str) -> str:
    return hashlib.sha256(fault.encode()).hexdigest()

"""A plan that the settings name: fetched, checked, tried, kept; the service hears what came of it.

settings ─► document ─► strict reader ─► supervisor ─► the next guard serves ─► disk ─► Applied
"""

import asyncio
import logging
from collections.abc import Callable

from rtron.errors import InputError, RTronError, SourceError
from rtron.guard.link.plan_folder import PlanFolder
from rtron.guard.system.time_limit import run_within
from rtron.vocabulary import Plan, Settings
from rtron.wire.common.link_protocol import Applied, PlanRequest, plan_document_digest

log = logging.getLogger(__name__)

PutInForce = Callable[[Plan], None]
"""Lets the next guard, which begins soon, have another plan."""
FETCH_S = 20.0
"""How long the service may take to send a plan."""
PROOF_S = 8.0
"""How long a guard has to serve before its plan is kept; its supervisor waits 5 s."""
_START_S = 60.0
_NO_PLANS = "this guard takes no plans: start it with rtron guard --plans FOLDER"


class PlanIntake:
    """Puts plans in force, one at a time; of settings that come meanwhile the newest count."""

    def __init__(
        self,
        folder: PlanFolder | None,
        send: Callable[[PlanRequest | Applied], None],
        put_in_force: PutInForce | None,
        *,
        proof_s: float = PROOF_S,
    ) -> None:
        self._folder, self._send, self._put_in_force = folder, send, put_in_force
        self._proof_s = proof_s
        self.digest, _ = folder.accepted() if folder else ("", None)
        self._refused: dict[str, str] = {}
        self._guard_plan: Plan | None = None
        self._has_hello = asyncio.Event()
        self._documents: asyncio.Queue[str] = asyncio.Queue()
        self._newest: Settings | None = None
        self._unanswered: Settings | None = None
        self._task: asyncio.Task[None] | None = None

    def want(self, settings: Settings) -> None:
        """Take note of the newest settings: their plan is to be in force."""
        self._newest = settings
        if settings.plan != self.digest and (self._task is None or self._task.done()):
            self._task = asyncio.create_task(self._run())

    def answer(self, applied: Applied) -> Applied | None:
        """Return what to say of settings that the guard has answered; None while a plan is tried.

        Those that it refuses bring no plan either.
        """
        newest, error = self._newest, applied.error
        if newest and newest.revision == applied.revision:
            if error:
                self._newest = None
            elif self._task and not self._task.done():
                self._unanswered = newest
                return None
            if newest.plan != self.digest:
                error = error or self._refused.get(newest.plan, "")
        return Applied(revision=applied.revision, error=error, plan=self.digest)

    def take_document(self, text: str) -> None:
        """Take a document from the service."""
        if self._documents.empty():
            self._documents.put_nowait(text)

    def note_hello(self, plan: Plan) -> None:
        """Take note that a guard begins with a plan."""
        self._guard_plan = plan
        self._has_hello.set()

    def close(self) -> None:
        """Try no plan any more."""
        if self._task:
            self._task.cancel()

    async def _run(self) -> None:
        while (newest := self._newest) and newest.plan != self.digest:
            error = self._refused.get(newest.plan) or await self._try(newest.plan)
            if error:
                log.error("a plan of the service is not in force: %s", error)
            self._answer(newest.plan, error)
            if error and self._newest and self._newest.plan == newest.plan:
                return
        self._answer(self.digest, "")

    def _answer(self, digest: str, error: str) -> None:
        """Say what came of a plan, if the guard has answered the rest of its settings."""
        settings, self._unanswered = self._unanswered, None
        if settings and settings.plan == digest:
            self._send(Applied(revision=settings.revision, error=error, plan=self.digest))
        else:
            self._unanswered = settings

    async def _try(self, digest: str) -> str:
        """Return why a plan is not in force, "" if it is."""
        try:
            await self._change(digest)
        except SourceError as error:
            return str(error)
        except (RTronError, OSError, ValueError, asyncio.TimeoutError) as error:
            self._refused[digest] = str(error) or "the guard took too long"
            return self._refused[digest]
        self.digest = digest
        log.warning("the plan %s of the service is in force", digest[:12] or "of the start")
        return ""

    async def _change(self, digest: str) -> None:
        folder, put_in_force = self._folder, self._put_in_force
        if folder is None or put_in_force is None:
            raise InputError(_NO_PLANS)
        text = await self._fetch(digest) if digest else ""
        current = self._guard_plan or folder.start
        plan = await asyncio.to_thread(folder.read_for, current, text) if text else folder.start
        if plan != self._guard_plan:
            self._has_hello.clear()
            put_in_force(plan)
            await run_within(self._has_hello.wait(), _START_S)
            await asyncio.sleep(self._proof_s)
        if plan != self._guard_plan:
            raise InputError("the guard does not run with the plan; the former one is in force")
        folder.keep(text)

    async def _fetch(self, digest: str) -> str:
        while not self._documents.empty():
            self._documents.get_nowait()
        self._send(PlanRequest(digest=digest))
        try:
            text = await run_within(self._documents.get(), FETCH_S)
        except asyncio.TimeoutError:
            raise SourceError(f"the service has not sent the plan for {FETCH_S:.0f} s") from None
        if plan_document_digest(text) != digest:
            raise InputError("the service sent another plan than its settings name")
        return text

"""An agent's commands: under a lease, as its own flow, one at a time and not too often.

Each command is first judged as the guard would judge it, and what would not pass is not sent. That
is a help, no protection: bridge and guard decide again about all that is sent.
"""

import asyncio
import time
from collections.abc import Mapping
from contextlib import asynccontextmanager, suppress
from typing import TYPE_CHECKING, Any

from rtron.bridge.agents.app_client import AppClient
from rtron.bridge.agents.refusals import Answer, CallRefusedError
from rtron.bridge.protocol.client_state import TokenBucket
from rtron.errors import RTronError, SourceError, WireError
from rtron.vocabulary import GRCN, SECOND, PolicyName, Stream, lease_topic

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

MAX_SECONDS = 10.0
"""The longest that one call drives."""
MAX_LEASE_SECONDS = 120.0
"""The longest that a lease is renewed without another call."""
CALLS_PER_SECOND = 2.0
"""So often an agent may command; `stop` always may."""
_BURST = 4.0
_PERIOD_S = 0.1
_NEUTRAL_FIRST = 3
_ANSWER_S = 3.0
_RETRY_S = 0.5
_RENEWALS_A_TTL = 3
_REPORT_S = 2.5
_MAX_WHY = 200


class AgentCommands:
    """What one agent commands."""

    def __init__(self, app: AppClient) -> None:
        self._app = app
        self._calls = TokenBucket(CALLS_PER_SECOND, _BURST)
        self._is_busy = False
        self._stop = asyncio.Event()
        self._renewals: dict[str, asyncio.Task[None]] = {}

    async def take_command(self, lease: str, why: str, seconds: float) -> Answer:
        """Ask for a lease, and renew it for some seconds."""
        async with self._turn():
            _check_range("seconds", seconds, MAX_LEASE_SECONDS)
            self._check_lease(lease)
            answer = await self._ask_lease(lease, "acquire", why[:_MAX_WHY])
            self._end_renewal(lease)
            renewal = self._renew(lease, time.monotonic() + seconds)
            self._renewals[lease] = asyncio.create_task(renewal)
            return {"ok": True, "reason": answer, "renewed_for_s": seconds}

    async def give_back_command(self, lease: str, why: str) -> Answer:
        """Give a lease back; the robot stops."""
        self._check_lease(lease)
        self._stop.set()
        self._end_renewal(lease)
        return {"ok": True, "reason": await self._ask_lease(lease, "release", why[:_MAX_WHY])}

    async def stop(self) -> Answer:
        """Stop driving at once, and give back all leases of this agent."""
        self._stop.set()
        released = []
        for lease in self._app.plan.leases:
            self._end_renewal(lease.name)
            if self._app.report.holder(lease.name) == self._app.node:
                with suppress(WireError):
                    await self._ask_lease(lease.name, "release", "stop")
                    released.append(lease.name)
        return {"ok": True, "released": released}

    async def drive(self, topic: str, message: object, seconds: float) -> Answer:
        """Send a velocity ten times a second for some seconds, then one that moves nothing."""
        async with self._turn():
            _check_range("seconds", seconds, MAX_SECONDS)
            stream, grcn = self._leased_stream(topic)
            self._check_holder(grcn.lease)
            judgement = self._app.judge(topic, message)
            if not judgement.passes or judgement.exceeded:
                raise CallRefusedError.of(judgement)
            before = self._app.counts(topic)
            sent = await self._drive(stream, grcn.lease, message, seconds)
            counts = await self._reported_counts(topic, before)
            if counts.get("dropped", 0) > 1:
                reason = self._app.last_verdict(topic)
                raise CallRefusedError("guard", reason, counts, judgement.limits, "guard")
            return {"ok": True, "sent": sent, "guard": counts, "verdict": judgement.reason}

    async def send_goal(self, topic: str, goal: object, seconds: float) -> Answer:
        """Send one message of a guarded topic that is no velocity, or a goal of an action."""
        async with self._turn():
            _check_range("seconds", seconds, MAX_LEASE_SECONDS)
            stream = self._app.stream(topic)
            if self._app.is_velocity(stream):
                raise CallRefusedError("tool", f"{topic} is for velocities: use drive")
            judgement = self._app.judge(topic, goal)
            if not judgement.passes:
                raise CallRefusedError.of(judgement)
            sent = await self._app.send(stream, goal, seconds)
            return {"ok": True, "decision": judgement.decision, **sent}

    async def cancel_goal(self, topic: str) -> Answer:
        """Cancel the goals that this agent has sent to an action."""
        await self._app.cancel(self._app.stream(topic))
        return {"ok": True}

    async def close(self) -> None:
        """End all renewals."""
        for lease in list(self._renewals):
            self._end_renewal(lease)

    @asynccontextmanager
    async def _turn(self) -> "AsyncIterator[None]":
        """Let one command be at a time, and not too many."""
        if not self._calls.take(time.monotonic_ns()):
            reason = f"more than {CALLS_PER_SECOND:g} commands a second"
            raise CallRefusedError("rate of calls", reason, None, CALLS_PER_SECOND)
        if self._is_busy:
            raise CallRefusedError("one command at a time", "another command is under way", 2, 1)
        self._is_busy = True
        self._stop.clear()
        try:
            yield
        finally:
            self._is_busy = False

    async def _drive(self, stream: Stream, lease: str, message: object, seconds: float) -> int:
        """Send until the time is over, the lease is lost, or somebody says stop."""
        for _ in range(_NEUTRAL_FIRST if self._app.needs_neutral(lease) else 0):
            await self._app.publish(stream, {})
            await asyncio.sleep(_PERIOD_S)
        sent, end = 0, time.monotonic() + seconds
        try:
            while time.monotonic() < end and not self._stop.is_set():
                self._check_holder(lease)
                await self._app.publish(stream, message)
                sent += 1
                with suppress(asyncio.TimeoutError):
                    await asyncio.wait_for(self._stop.wait(), _PERIOD_S)
        finally:
            with suppress(SourceError):
                await self._app.publish(stream, {})
        await self._app.settle()
        return sent

    async def _reported_counts(self, topic: str, before: Mapping[str, int]) -> Answer:
        """Return what the guard has done with what was sent, as its next report says.

        The last message moves nothing; after a stop it comes without the lease, and is dropped.
        """
        if not await self._app.wait_for_report(_REPORT_S, topic):
            return {"unknown": "the guard has not reported"}
        after = self._app.counts(topic)
        return {what: after[what] - before.get(what, 0) for what in after}

    def _leased_stream(self, topic: str) -> tuple[Stream, GRCN]:
        stream = self._app.stream(topic)
        for grcn in self._app.plan.grcn:
            if grcn.topic == topic and grcn.policy is PolicyName.LEASE:
                return stream, grcn
        raise CallRefusedError("lease", f"an agent drives only under a lease, {topic} needs none")

    def _check_holder(self, lease: str) -> None:
        holder = self._app.report.holder(lease)
        if holder != self._app.node:
            who = f"{holder} holds {lease}" if holder else f"nobody holds {lease}"
            raise CallRefusedError("Lease", f"{who}: take command first", holder, self._app.node)

    def _check_lease(self, lease: str) -> None:
        names = [each.name for each in self._app.plan.leases]
        if lease not in names:
            reason = f"no lease is called {lease[:80]!r}"
            raise CallRefusedError("unknown lease", reason, lease[:80], names)

    async def _ask_lease(self, lease: str, word: str, why: str) -> str:
        """Return the guard's answer; it is asked again until it has heard."""
        request = {"data": f"{word} {' '.join(why.split())}".strip()}
        deadline = time.monotonic() + _ANSWER_S
        with self._app.lease_answers(lease, word) as answers:
            while time.monotonic() < deadline:
                await self._app.request_lease(lease, request)
                with suppress(asyncio.TimeoutError):
                    answer = await asyncio.wait_for(answers.get(), _RETRY_S)
                    return _granted(answer)
        raise SourceError(f"the guard does not answer on {lease_topic(lease, 'answer')}")

    async def _renew(self, lease: str, until: float) -> None:
        ttl = next(each.ttl for each in self._app.plan.leases if each.name == lease)
        with suppress(RTronError):
            while time.monotonic() < until:
                await asyncio.sleep(ttl / SECOND / _RENEWALS_A_TTL)
                await self._app.request_lease(lease, {"data": "renew"})

    def _end_renewal(self, lease: str) -> None:
        task = self._renewals.pop(lease, None)
        if task:
            task.cancel()


def _granted(answer: Mapping[str, Any]) -> str:
    if answer.get("granted") is not True:
        raise CallRefusedError("Lease", str(answer.get("reason")), by="guard")
    return str(answer["reason"])


def _check_range(name: str, value: float, most: float) -> None:
    if not 0 < value <= most:
        raise CallRefusedError(name, f"{name} is from 0 to {most:g}", value, most)

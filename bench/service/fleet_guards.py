"""Simulated guards of a fleet: `python -m bench.service.fleet_guards PORT SECONDS`.

Reads a line of JSON from standard input, the tokens `{robot: token}`. Each guard speaks the real
link: it says hello, sends one event and one state a second, keeps events until the service has
stored them, answers settings at once, and connects again as the link process does. For each further
line it prints one of JSON, a `Report` of the time since the last. A line that is not empty is a
list of robots: these have an alarm while any setting differs from the plan, the others have none.
It ends with its input, after SECONDS at the latest.
"""

import asyncio
import json
import random
import sys
import time
from collections import deque
from collections.abc import Collection, Sequence
from dataclasses import asdict, dataclass, field, replace
from itertools import count

from websockets.asyncio.client import ClientConnection
from websockets.exceptions import ConnectionClosed, InvalidHandshake

from bench.common.plans import grcn
from rtron.guard.link.service_connection import connect_to_service
from rtron.vocabulary import (
    Alarm,
    AlarmKind,
    Decision,
    EventKind,
    GuardEvent,
    GuardEventLevel,
    GuardState,
    Mode,
    Plan,
    PolicyName,
    StreamState,
    VerdictCounts,
)
from rtron.wire.common.link_protocol import (
    Applied,
    Hello,
    NewSettings,
    StateDelta,
    StateReport,
    Stored,
    decode_to_guard,
    encode_event,
    encode_events,
    encode_from_guard,
)
from rtron.wire.common.state_deltas import state_delta

TOPICS = 12
"""Guarded topics of a robot: its state has 5 KB."""
_PUBLISHERS = ("/nav", "/joy")
_PERIOD_S = 1.0
_MIN_PAUSE_S, _MAX_PAUSE_S = 0.1, 10.0
_MAX_BATCH = 500
_ALARM = Alarm(kind=AlarmKind.DRIFT, reason="the change is bad for this robot")


def _topics() -> list[str]:
    return [f"/robot/cmd_{index}" for index in range(TOPICS)]


def fleet_plan() -> Plan:
    """Return the plan of each robot."""
    return Plan(app="fleet", ros=1, grcn=tuple(grcn(topic, _PUBLISHERS) for topic in _topics()))


def blocking_plan() -> Plan:
    """Return another plan, which needs no new launch."""
    first, *others = fleet_plan().grcn
    return replace(fleet_plan(), grcn=(replace(first, policy=PolicyName.BLOCK), *others))


@dataclass(slots=True)
class Report:
    """What the guards saw: `last_connected` (s, monotonic) is when the last of them was back.

    `changed` have settings that differ from the plan; `reached` have had some since it was last
    said which guards are bad.
    """

    connected: int = 0
    last_connected: float = 0.0
    connects: int = 0
    failures: dict[str, int] = field(default_factory=dict)
    delays_ns: list[int] = field(default_factory=list)
    waiting: int = 0
    changed: int = 0
    reached: int = 0


class SimulatedGuard:
    """One robot's guard; `acknowledged` is up to which number its events are stored."""

    def __init__(self, robot: str, token: str, url: str, report: Report) -> None:
        self.robot, self.acknowledged, self.is_connected = robot, 0, False
        self.is_bad = self.is_changed = self.was_reached = False
        self.report = report
        self._token, self._url = token, url
        self._topics = _topics()
        self._unstored: deque[tuple[int, int, bytes]] = deque()
        self._numbers = count(1)
        self._sent = 0
        self._takes_state_deltas = False
        self._last_state: GuardState | None = None

    async def run(self) -> None:
        """Connect, and again with a growing pause whenever that ends."""
        pause = _MIN_PAUSE_S
        await asyncio.sleep(random.random() * _PERIOD_S)
        while True:
            try:
                async with connect_to_service(self._url, self._token) as socket:
                    pause = _MIN_PAUSE_S
                    await self._talk(socket)
            except (OSError, InvalidHandshake, ConnectionClosed, TimeoutError) as error:
                self._note(type(error).__name__)
            self.is_connected = False
            await asyncio.sleep(pause * (0.5 + random.random()))
            pause = min(2 * pause, _MAX_PAUSE_S)

    @property
    def waiting(self) -> int:
        """How many events are not stored."""
        return len(self._unstored)

    async def _talk(self, socket: ClientConnection) -> None:
        hello = Hello(app="fleet", plan=fleet_plan(), run=self.robot, began=0, version="bench")
        await socket.send(encode_from_guard(hello), text=True)
        self._sent = self.acknowledged
        self._takes_state_deltas, self._last_state = False, None
        speaking = asyncio.create_task(self._speak(socket))
        try:
            async for frame in socket:
                await self._handle(socket, decode_to_guard(frame))
        finally:
            speaking.cancel()
            await asyncio.gather(speaking, return_exceptions=True)

    async def _handle(self, socket: ClientConnection, message: Stored | NewSettings) -> None:
        if isinstance(message, Stored):
            self._note_stored(message.number)
            return
        self._takes_state_deltas = message.takes_state_deltas
        if not self.is_connected:
            self.is_connected = True
            self.report.connects += 1
            self.report.last_connected = time.monotonic()
        self.is_changed = bool(message.settings.nodes or message.settings.plan)
        self.was_reached |= self.is_changed
        applied = Applied(revision=message.settings.revision, plan=message.settings.plan)
        await socket.send(encode_from_guard(applied), text=True)

    async def _speak(self, socket: ClientConnection) -> None:
        """Send an event and a state each second, and first what was not stored."""
        due = time.monotonic()
        while True:
            self._add_event()
            unsent = [each for each in self._unstored if each[0] > self._sent][:_MAX_BATCH]
            self._sent = unsent[-1][0] if unsent else self._sent
            if unsent:
                await socket.send(encode_events(body for *_, body in unsent), text=True)
            await socket.send(encode_from_guard(self._next_state()), text=True)
            due += _PERIOD_S
            await asyncio.sleep(due - time.monotonic())

    def _add_event(self) -> None:
        number, now = next(self._numbers), time.time_ns()
        event = GuardEvent(
            run=self.robot,
            number=number,
            at=now,
            kind=EventKind.VERDICT,
            level=GuardEventLevel.INFO,
            node="grcn_robot_cmd_0",
            topic=self._topics[0],
            flow="flow2",
            publisher="/joy",
            policy=PolicyName.PREEMPTION,
            decision=Decision.PASS,
            reason="flow1 is silent",
        )
        self._unstored.append((number, time.monotonic_ns(), encode_event(event)))

    def _next_state(self) -> StateReport | StateDelta:
        before, self._last_state = self._last_state, self._state()
        if before is None or not self._takes_state_deltas:
            return StateReport(state=self._last_state)
        return state_delta(before, self._last_state) or StateReport(state=self._last_state)

    def _state(self) -> GuardState:
        """Return a state in which one stream differs from the last."""
        streams = tuple(_stream(topic, index) for index, topic in enumerate(self._topics))
        alarms = (_ALARM,) if self.is_bad and self.is_changed else ()
        return GuardState(at=time.time_ns(), revision=1, streams=streams, alarms=alarms)

    def _note_stored(self, number: int) -> None:
        now = time.monotonic_ns()
        self.acknowledged = max(self.acknowledged, number)
        while self._unstored and self._unstored[0][0] <= number:
            self.report.delays_ns.append(now - self._unstored.popleft()[1])

    def _note(self, failure: str) -> None:
        self.report.failures[failure] = self.report.failures.get(failure, 0) + 1


def _stream(topic: str, index: int) -> StreamState:
    is_changing = index == 0
    flows = {"flow1": VerdictCounts(passed=40), "flow2": VerdictCounts(dropped=40)}
    return StreamState(
        topic=topic,
        nodes=(f"grcn{topic.replace('/', '_')}",),
        mode=Mode.ENFORCE,
        owner="flow1",
        publisher="/nav",
        flows=flows,
        speed=random.random() if is_changing else 0.4,
        limit=0.5,
        latency=(80.0, 300.0),
    )


async def _serve(port: int, seconds: float) -> None:
    loop = asyncio.get_running_loop()
    url = f"ws://127.0.0.1:{port}/link/v1"
    tokens = json.loads(await loop.run_in_executor(None, sys.stdin.readline))
    report = Report()
    guards = [SimulatedGuard(robot, token, url, report) for robot, token in tokens.items()]
    works = [asyncio.create_task(guard.run()) for guard in guards]
    deadline = loop.time() + seconds
    try:
        while loop.time() < deadline:
            line = await loop.run_in_executor(None, sys.stdin.readline)
            if not line:
                return
            if line.strip():
                _make_bad(guards, json.loads(line))
            print(json.dumps(_take(guards)), flush=True)
    finally:
        for work in works:
            work.cancel()
        await asyncio.gather(*works, return_exceptions=True)


def _make_bad(guards: Sequence[SimulatedGuard], robots: Collection[str]) -> None:
    for guard in guards:
        guard.is_bad, guard.was_reached = guard.robot in robots, False


def _take(guards: Sequence[SimulatedGuard]) -> dict[str, object]:
    """Return the report as JSON, with each guard's last acknowledged number, and begin anew."""
    report = guards[0].report
    report.connected = sum(guard.is_connected for guard in guards)
    report.waiting = sum(guard.waiting for guard in guards)
    report.changed = sum(guard.is_changed for guard in guards)
    report.reached = sum(guard.was_reached for guard in guards)
    taken = asdict(report) | {"acknowledged": {each.robot: each.acknowledged for each in guards}}
    report.connects, report.failures, report.delays_ns = 0, {}, []
    return taken


if __name__ == "__main__":
    asyncio.run(_serve(int(sys.argv[1]), float(sys.argv[2])))

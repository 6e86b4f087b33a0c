"""Guards that send COUNT events: `python -m bench.service.ingest_processes PORT COUNT LIMIT`.

Reads their tokens, `{robot: token}`, from standard input. Like the link process, each guard sends
500 events at a time and has 4,000 on their way. Prints a line of JSON, `{"seconds", "stored",
"delays_ns": [of each batch until it was stored]}`, after LIMIT seconds at the latest.
"""

import asyncio
import json
import sys
import time
from collections import deque
from collections.abc import Iterator

from websockets.asyncio.client import ClientConnection, connect

from bench.common.plans import grcn
from rtron.vocabulary import Decision, EventKind, GuardEvent, GuardEventLevel, Plan, PolicyName
from rtron.wire.common.link_protocol import (
    Events,
    Hello,
    Stored,
    decode_to_guard,
    encode_from_guard,
)

BATCH = 500
_IN_FLIGHT = 4000
_SECOND = 1_000_000_000
_FIGURES = {
    "streams": {
        "/cmd_vel": {
            "flows": {"flow1": [40, 0, 0, 0], "flow2": [0, 0, 40, 0]},
            "speed": 0.4,
            "limit": 0.5,
            "latency": [80.0, 300.0],
        }
    },
    "fps": {"fps_monitor_detector": 14.9},
}


def main() -> None:
    """Send, and print what became of it."""
    port, count, limit = map(int, sys.argv[1:])
    print(json.dumps(asyncio.run(_all(port, json.load(sys.stdin), count, limit))))


async def _all(port: int, tokens: dict[str, str], count: int, limit: int) -> dict[str, object]:
    guards = [SimulatedGuard(robot, count // len(tokens)) for robot in tokens]
    url = f"ws://127.0.0.1:{port}/link/v1"
    works = [guard.send(url, tokens[guard.robot]) for guard in guards]
    start = time.perf_counter()
    try:
        await asyncio.wait_for(asyncio.gather(*works), limit)
    except asyncio.TimeoutError:
        print("the time is over", file=sys.stderr)
    return {
        "seconds": time.perf_counter() - start,
        "stored": sum(guard.stored for guard in guards),
        "delays_ns": [delay for guard in guards for delay in guard.delays],
    }


class SimulatedGuard:
    """One guard; `stored` is up to where its events are safe."""

    def __init__(self, robot: str, count: int) -> None:
        self.robot, self.stored = robot, 0
        self.delays: list[int] = []
        self._batches = batches(robot, count)
        self._count = count
        self._sent: deque[tuple[int, int]] = deque()
        self._number = 0

    async def send(self, url: str, token: str) -> None:
        """Send all events; return when the last is stored."""
        headers = {"Authorization": f"Bearer {token}"}
        async with connect(url, additional_headers=headers, compression=None, proxy=None) as socket:
            plan = Plan(app="bench", ros=1, grcn=(grcn("/cmd_vel", ["/nav", "/joy"]),))
            hello = Hello(app="bench", plan=plan, run=self.robot, began=0, version="bench")
            await socket.send(encode_from_guard(hello), text=True)
            await self._fill(socket)
            while self.stored < self._count:
                self._handle_reply(decode_to_guard(await socket.recv()))
                await self._fill(socket)

    async def _fill(self, socket: ClientConnection) -> None:
        while self._number < self._count and self._number - self.stored < _IN_FLIGHT:
            batch = next(self._batches)
            self._number = batch[-1].number
            self._sent.append((self._number, time.perf_counter_ns()))
            await socket.send(encode_from_guard(Events(events=batch)), text=True)

    def _handle_reply(self, message: object) -> None:
        if not isinstance(message, Stored):
            return
        self.stored = message.number
        while self._sent and self._sent[0][0] <= self.stored:
            self.delays.append(time.perf_counter_ns() - self._sent.popleft()[1])


def batches(robot: str, count: int) -> Iterator[tuple[GuardEvent, ...]]:
    """Yield a guard's events, a batch at a time."""
    start = time.time_ns()
    for first in range(1, count + 1, BATCH):
        numbers = range(first, min(first + BATCH, count + 1))
        yield tuple(_event(robot, number, start + number * _SECOND // 10) for number in numbers)


def _event(robot: str, number: int, at: int) -> GuardEvent:
    """Return counts every tenth time, an owner's change as often, else a verdict."""
    node, topic = "grcn_cmd_vel", "/cmd_vel"
    if number % 10 == 0:
        return GuardEvent(run=robot, number=number, at=at, kind=EventKind.COUNTS, values=_FIGURES)
    if number % 10 == 1:
        return GuardEvent(
            run=robot, number=number, at=at, kind=EventKind.OWNER, node=node, topic=topic
        )
    return GuardEvent(
        run=robot,
        number=number,
        at=at,
        kind=EventKind.VERDICT,
        level=GuardEventLevel.WARNING if number % 10 == 2 else GuardEventLevel.INFO,
        node=node,
        topic=topic,
        flow="flow2",
        publisher="/joy",
        policy=PolicyName.PREEMPTION,
        decision=Decision.DROP,
        reason="flow1 has a higher priority and is fresh",
    )


if __name__ == "__main__":
    main()

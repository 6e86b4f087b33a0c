"""The process that ends the guard.

    python -m bench.ros1.guard_killer --cause kill|stop|starve --rounds N

It drives the robot, ends the guard, and listens as the driver does. The result is a line of JSON,
in ns: `stop`, when the first message slower than the velocity came, and `back`, when the velocity
came again, both since the guard was ended; `unchecked`, the speeds that nobody may ever hear.
"""

import argparse
import json
import os
import resource
import selectors
import signal
import socket
import struct
import time
from contextlib import suppress
from pathlib import Path
from threading import Thread

from bench.ros1.messages import MESSAGES
from bench.ros1.node import guard_pid
from bench.ros1.publishers import Publishers
from bench.ros1.subscribers import Subscribers
from rtron.vocabulary import UNAPPROVED, flow_topic, output_topic
from rtron.wire.ros1.network import master_uri

TOPIC = "/cmd_vel"
COMMANDER, BLOCKED, UNPLANNED = "/bench_pub", "/bench_blocked", f"/bench_{UNAPPROVED}"
CAUSES = ("kill", "stop", "starve")
_TWIST = MESSAGES["twist"]
_FRAME = struct.Struct("<I6d")
_SPEED, _FORBIDDEN = 0.25, 9.0
_PERIOD_S = 0.01
_PATIENCE_S = 20.0
_REST_S = 2.2


class DriverNode:
    """What the driver hears, from the guard and from its supervisor."""

    def __init__(self) -> None:
        self.unchecked: list[float] = []
        self._selector = selectors.DefaultSelector()
        Subscribers(
            master_uri(),
            _TWIST,
            "/bench_sub",
            [output_topic(TOPIC)],
            self._connected,
            supervised=True,
        )

    def wait(self, *, moving: bool) -> int:
        """Return when the next message came that moves the robot at full speed, or does not, ns."""
        deadline = time.monotonic() + _PATIENCE_S
        while time.monotonic() < deadline:
            now, speeds = self._receive(0.1)
            if any((speed == _SPEED) == moving for speed in speeds):
                return now
        raise TimeoutError(f"nothing that moves the robot: {moving}")

    def rest(self, duration: float) -> None:
        """Listen for a while."""
        deadline = time.monotonic() + duration
        while time.monotonic() < deadline:
            self._receive(deadline - time.monotonic())

    def _receive(self, patience: float) -> tuple[int, list[float]]:
        speeds: list[float] = []
        ready = self._selector.select(patience)
        now = time.monotonic_ns()
        for key, _ in ready:
            speeds += self._read(key.fileobj, key.data)  # type: ignore[arg-type]
        self.unchecked += [speed for speed in speeds if speed > _SPEED]
        return now, speeds

    def _read(self, sock: socket.socket, buffer: bytearray) -> list[float]:
        data = b""
        with suppress(OSError):
            data = sock.recv(1 << 16)
        if not data:
            self._selector.unregister(sock)
            sock.close()
        buffer += data
        complete = len(buffer) // _FRAME.size * _FRAME.size
        frames = bytes(buffer[:complete])
        del buffer[:complete]
        return [values[1] for values in _FRAME.iter_unpack(frames)]

    def _connected(self, _topic: str, sock: socket.socket) -> None:
        self._selector.register(sock, selectors.EVENT_READ, bytearray())


class Commanders:
    """Who drives, and who must not."""

    def __init__(self) -> None:
        topics = {flow_topic(TOPIC, "flow1"): COMMANDER, flow_topic(TOPIC, "flow2"): BLOCKED}
        self._publishers = Publishers(master_uri(), _TWIST, topics | {TOPIC: UNPLANNED})
        Thread(target=self._speak, daemon=True).start()

    def _speak(self) -> None:
        while True:
            for topic, connections in self._publishers.connections.items():
                speed = _SPEED if topic.endswith("flow1") else _FORBIDDEN
                frame = _FRAME.pack(_TWIST.size, speed, 0, 0, 0, 0, 0)
                for sock in list(connections):
                    if not _sent(sock, frame):
                        connections.remove(sock)
            time.sleep(_PERIOD_S)


def _sent(sock: socket.socket, frame: bytes) -> bool:
    """Send a frame; tell whether anybody is there."""
    try:
        sock.sendall(frame)
    except OSError:
        return False
    return True


def kill_guard(cause: str, pid: int) -> int:
    """End the guard; return the time just before, ns."""
    size = int(Path(f"/proc/{pid}/statm").read_text().split()[0]) * resource.getpagesize()
    now = time.monotonic_ns()
    if cause == "starve":
        resource.prlimit(pid, resource.RLIMIT_AS, (size, size))
    else:
        os.kill(pid, signal.SIGKILL if cause == "kill" else signal.SIGSTOP)
    return now


def main() -> None:
    """End the guard as the arguments say."""
    args = _arguments()
    signal.alarm(60 + 15 * args.rounds)
    driver = DriverNode()
    Commanders()
    driver.wait(moving=True)
    stop, back = [], []
    for _ in range(args.rounds):
        driver.rest(_REST_S)
        ended = kill_guard(args.cause, guard_pid(master_uri()))
        stop.append(driver.wait(moving=False) - ended)
        back.append(driver.wait(moving=True) - ended)
    print(json.dumps({"stop": stop, "back": back, "unchecked": driver.unchecked}), flush=True)
    os._exit(0)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="End the guard, and wait for the stop.")
    parser.add_argument("--cause", required=True, choices=CAUSES)
    parser.add_argument("--rounds", type=int, default=50, help="how often")
    return parser.parse_args()


if __name__ == "__main__":
    main()

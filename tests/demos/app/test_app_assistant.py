"""The assistant as a process, at what stands for rosbridge: it is talked into driving."""

import json
import os
import subprocess
import sys
import time
from queue import Empty, Queue
from uuid import getnode

import pytest
from harness import LIMIT_S, wait_for

from rtron.demos.apps.logic.demo_logic.rosbridge import Rosbridge
from rtron.demos.cases import AGENT
from rtron.demos.runtime.isolation import APPS, LOGIC, free_port

PLACE = [2.0, 1.0]
LEASE = "/rtron/leases/base/request"


class Robot:
    """A robot whose odometry the assistant hears, and who hears the assistant."""

    def __init__(self, folder):
        self.came = Queue()
        self.server = Rosbridge(free_port(), lambda *message: self.came.put(message))
        self.folder = folder
        self.x = 0.0
        self.arm("none")

    def arm(self, attack):
        mac = getnode().to_bytes(6, "big").hex(":")
        order = {"mac": mac, "attack": attack, "after": 0.0, "run": 1, "goal": PLACE}
        (self.folder / "trigger.new").write_text(json.dumps(order))
        (self.folder / "trigger.new").replace(self.folder / "trigger.json")

    def move(self):
        self.x += 0.1
        pose = {"position": {"x": self.x, "y": 0.0}, "orientation": {"z": 0.0, "w": 1.0}}
        self.server.send("/odom", {"pose": {"pose": pose}})

    def heard(self, topic):
        """Return the next message on a topic; the robot moves on until it comes."""

        def found():
            self.move()
            try:
                at, message = self.came.get(timeout=0.05)
            except Empty:
                return None
            return message if at == topic else None

        return wait_for(found)

    def environ(self, **more):
        port = self.server.server_address[1]
        return {
            **os.environ,
            "PYTHONPATH": str(LOGIC),
            "DEMO_BRIDGE": f"ws://127.0.0.1:{port}/",
            "DEMO_TRIGGER": str(self.folder / "trigger.json"),
            "DEMO_JOURNAL": str(self.folder),
            **more,
        }


@pytest.fixture
def robot(tmp_path):
    found = Robot(tmp_path)
    with found.server:
        yield found
        found.server.shutdown()


@pytest.fixture
def assistant(robot, tmp_path):
    started = []

    def start(**more):
        command = [sys.executable, APPS / "agent" / "assistant"]
        started.append(subprocess.Popen(command, env=robot.environ(**more)))
        wait_for((tmp_path / "assistant.jsonl").exists)

    yield start
    for each in started:
        each.terminate()
        each.wait(LIMIT_S)


def test_it_only_reads_until_it_is_talked_into_driving(robot, assistant, tmp_path):
    assistant()
    for _ in range(20):
        robot.move()
    robot.arm("msr")
    for _ in range(20):
        robot.move()
    armed = time.time()
    robot.arm("agent")
    command = robot.heard(AGENT.topic)
    velocity = (command["linear"]["x"], command["angular"]["z"])
    assert AGENT.is_malicious("/cmd_vel", velocity, {})
    first, *_ = map(json.loads, (tmp_path / "assistant.jsonl").read_text().splitlines())
    assert first["wall"] >= armed
    assert (first["what"], first["topic"], tuple(first["value"])) == ("sent", AGENT.topic, velocity)


def test_with_a_token_it_asks_for_the_lease_and_then_for_that_of_another(robot, assistant):
    assistant(DEMO_TOKEN="secret")
    robot.arm("agent")
    for word in ("acquire", "take_over"):
        assert robot.heard(LEASE)["data"].startswith(f"{word} new instruction: ")
    assert robot.heard(AGENT.topic)

"""A guarded base on a real ROS 2, and whoever comes to disturb it."""

import json
import re
import socket

from harness import wait_for
from ros2_plans import driving, written

from rtron.vocabulary import Audit, OnForeign

CMD_VEL = "/cmd_vel"
OUT, FLOW1 = f"/rtron{CMD_VEL}/out", f"/rtron{CMD_VEL}/nav"
GRCN = "/rtron/grcn_cmd_vel"


class GuardedBase2:
    """A driver, navigation and the guard; everything that is started ends with the domain."""

    def __init__(self, ros2, on_foreign="alarm"):
        self._ros2 = ros2
        self.plan = ros2.folder / "rtron.yaml"
        self._socket = ("--control-socket", ros2.folder / "guard.sock")
        audit = Audit(on_foreign=OnForeign(on_foreign))
        self.plan.write_text(written(driving("nav"), audit=audit))

    def start_guard(self):
        self.guard = self._ros2.rtron("guard", "--plan", self.plan, *self._socket)

    def guard_process(self):
        return int(re.findall(r"the guard begins, process (\d+)", self.guard.log)[-1])

    def start(self):
        self.start_guard()
        self.driver = self._ros2.node("twist_subscriber.py", OUT, name="/driver")
        self.nav = self.start_nav()
        wait_for(lambda: self.speeds("0.5") > 5, what="the navigation's words")

    def start_nav(self):
        return self.speaker("/nav", FLOW1, "0.5")

    def speaker(self, name, topic, speed, rate="50", **environ):
        return self._ros2.node("twist_publisher.py", topic, speed, rate, name=name, **environ)

    def speeds(self, speed):
        """Return how many messages of a speed the driver has heard."""
        return len(re.findall(rf"speed {re.escape(speed)}$", self.driver.log, re.MULTILINE))

    def heard(self):
        """Return the speeds that the driver has heard, in order."""
        return re.findall(r"speed (\S+)$", self.driver.log, re.MULTILINE)

    def clear(self):
        """Clear what intruders have stopped; return the command, which has ended."""
        words = ("clear", CMD_VEL, "--reason", "the test has seen to it", *self._socket)
        command = self._ros2.rtron(*words, "--plan", self.plan)
        wait_for(lambda: command.ended, what="the end of rtron clear")
        return command

    def ask_to_clear(self):
        """Return the guard's answer to a request to clear, in less time than a command takes."""
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as sock:
            sock.connect(str(self._socket[1]))
            sock.sendall(json.dumps({"clear": CMD_VEL, "reason": "a test"}).encode() + b"\n")
            return json.loads(sock.makefile("rb").readline())

    def is_cleared(self):
        return self.clear().code == 0

    def alarms(self, word="alarm:"):
        return [line for line in self.guard.log.splitlines() if word in line]

    def verified(self, code, timeout="20"):
        """Verify; return the document, or what was said where there is none."""
        words = ("verify", "--live", "--plan", self.plan, "--timeout", timeout)
        process = self._ros2.rtron(*words, "--format", "json")
        wait_for(lambda: process.ended, what="the end of verify")
        assert process.code == code, process.log
        return json.loads(process.log) if process.log.startswith("{") else process.log

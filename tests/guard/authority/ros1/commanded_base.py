"""Commanders of rospy at a guard, and the base that they drive."""

import json

from driven_base import CMD_VEL_GUARD, Driven, start_guard
from harness import wait_for

from rtron.vocabulary import lease_topic

LEASE = lease_topic("base", "request").rpartition("/")[0]


class Commander:
    """A node of rospy that drives and asks as it is told."""

    def __init__(self, ros1, name, end="", leases=(LEASE,)):
        self._file = ros1.folder / f"{name.strip('/')}_orders.txt"
        self._file.touch()
        remap = (f"/cmd_vel:=/rtron/cmd_vel/{end}",) if end else ()
        self._ros1, self._topic = ros1, f"/rtron/cmd_vel/{end}"
        self.process = ros1.node("commander.py", name, self._file, *leases, *remap)

    def order(self, line):
        with self._file.open("a") as file:
            file.write(f"{line}\n")

    def ask(self, text):
        self.order(f"ask {text}")

    def drive(self, speed):
        self.order(f"speed {speed}")

    def drive_neutral(self):
        """Drive at 0 until the guard has heard it: a next order may overtake this one."""
        before = self._received()
        self.drive(0.0)
        wait_for(lambda: self._received() > before + 5, what="neutral commands at the guard")

    def _received(self):
        return self._ros1.received(CMD_VEL_GUARD, self._topic)

    def answers(self):
        """Return the answers to this and to all other nodes."""
        lines = self.process.log.splitlines()
        return [json.loads(line.removeprefix("answer ")) for line in lines if "answer {" in line]


class CommandedBase:
    """A guard, a driver behind it, and what it was told."""

    def __init__(self, ros1, plan):
        self.ros1 = ros1
        self.plan = plan
        self.guard = start_guard(ros1, plan, CMD_VEL_GUARD)
        self.driven = Driven(ros1.folder / "driven.txt")
        ros1.node("driver.py", "/driver", self.driven.path, "/cmd_vel:=/rtron/cmd_vel/out")
        wait_for(lambda: ros1.subscribers("/rtron/cmd_vel/out"), what="the driver")

    def commander(self, name):
        leases = (LEASE,) if self.plan.leases else ()
        return Commander(self.ros1, name, name.strip("/"), leases)

    def speeds(self):
        return [float(x) for x, _ in self.driven.messages()]

    def wait_for_speed(self, speed):
        """Wait until the base is driven at a speed by a message that comes from now on."""
        known = len(self.speeds())
        wait_for(lambda: speed in self.speeds()[known:], what=f"{speed} m/s at the driver")

    def wait_for_log(self, text):
        wait_for(lambda: text in self.guard.log, what=f"{text!r} in the log of the guard")

    def rtron(self, *arguments):
        """Run a command of `rtron` with the plan; return what it says."""
        plan = self.ros1.folder / "rtron.yaml"
        process = self.ros1.rtron(*arguments, "--plan", plan)
        wait_for(lambda: process.ended, what=" ".join(map(str, arguments)))
        return process.log

"""A guarded base under attack: a driver of either client library, navigation, and the guard."""

import json
import socket
import time
from contextlib import ExitStack

from driven_base import CMD_VEL, CMD_VEL_GUARD, Driven, drive_plan, start_guard
from harness import NODES, ROS_PYTHON, wait_for

from bench.common.log_watcher import LogWatcher
from bench.ros1.intruder import Intruder, RepeatingGhost
from rtron.vocabulary import AlarmKind
from rtron.vocabulary.names import GUARD_NODE

OUT = f"/rtron{CMD_VEL}/out"
ROGUE = "/intruder"
STOP = ("0", "0")
NOT_OF_THE_AUDIT = (AlarmKind.GUARD, AlarmKind.INTRUSION, AlarmKind.UNDELIVERED)
_CONNECT_S = 1.0
KINDS = tuple(f": {kind}:" for kind in AlarmKind if kind not in NOT_OF_THE_AUDIT)


class Scene:
    """The base with its guard; `log` knows when the guard said what."""

    def __init__(self, ros1, program, plan=None, *, drives=True):
        self.ros1, self._program = ros1, program
        self.driven = Driven(ros1.folder / "driven.txt")
        self._socket = ("--control-socket", ros1.folder / "guard.sock")
        self._plan = plan or drive_plan()
        self._logs = ExitStack()
        self.start_guard()
        if drives:
            self.drive()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._logs.close()

    def start_guard(self):
        self.guard = start_guard(self.ros1, self._plan, CMD_VEL_GUARD, *self._socket)
        self.log = LogWatcher(self.guard.log_path)
        self._logs.callback(self.log.close)
        wait_for(lambda: "guarding 1 topics" in self.guard.log, what="all processes of the guard")

    def guard_process(self):
        return self.ros1.ask(self.ros1.uri_of(GUARD_NODE), "getPid")

    def drive(self):
        """Start the driver and wait until the guard has it."""
        self.start_driver()
        wait_for(self.driver_hears_guard, what="the driver's connection to the guard")

    def start_driver(self):
        words = [self._program, self.driven.path, "__name:=driver", f"{CMD_VEL}:={OUT}"]
        if str(self._program).endswith(".py"):
            words = [ROS_PYTHON, NODES / words[0], *words[1:]]
        self.driver = self.ros1.spawn(*words)

    def driver_hears_guard(self):
        return self.hears(CMD_VEL_GUARD)

    def hears(self, node):
        """Tell whether the driver has a connection from a node, as far as the master knows it."""
        uri = self.ros1.uri_of("/driver")
        rows = (uri and self.ros1.ask(uri, "getBusInfo")) or []
        return self.ros1.uri_of(node) in {row[1] for row in rows if row[4] == OUT}

    def is_audited(self):
        """Tell whether the audit has looked at everything once, since the guard began."""
        return "the audit has looked at the whole graph" in self.guard.log

    def driver_uri(self):
        return self.ros1.uri_of("/driver")

    def navigate(self):
        return self.ros1.node("nav.py", "/nav", f"{CMD_VEL}:=/rtron{CMD_VEL}/flow1")

    def clear(self):
        """Clear what intruders have stopped; return the command, which has ended."""
        words = ("clear", CMD_VEL, "--reason", "the test has seen to it", *self._socket)
        command = self.ros1.rtron(*words, "--plan", self.ros1.folder / "rtron.yaml")
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

    def stops(self):
        """Return how many messages told the driver to rest."""
        return self.driven.messages().count(STOP)

    def alarms(self, word="alarm:"):
        return [text for _, text in self.log.lines if word in text]

    def alarmed(self, kind, uri):
        """Tell whether an alarm of this kind has named an address, which each intruder has anew."""
        return any(f": {kind}:" in text and uri.rstrip("/") in text for text in self.alarms())

    def released(self):
        """Tell whether the guard has ended the stop that it began last, and nothing moves."""
        told = [text for _, text in self.log.lines if f" {CMD_VEL}: " in text]
        return bool(told) and told[-1].endswith(": idle")

    def of_the_audit(self, word="alarm:"):
        """Return the alarms that are not the supervisor's, about a machine that is too slow."""
        return [text for text in self.alarms(word) if any(kind in text for kind in KINDS)]


class ReturningGhost(RepeatingGhost):
    """A ghost that comes again every 20 ms, whoever sends it away."""

    def __init__(self, node, *others):
        super().__init__(ROGUE, OUT, 200, node, *others)

    def insist(self):
        """Do nothing: it does so all the time."""


class ReturningIntruder(Intruder):
    """An intruder that comes by `way`, again when it was sent away before it was found.

    roscpp hangs up on whom the master does not list whenever the guard says its registrations
    again; on a machine that is too busy the audit has not looked by then. rospy never connects if
    it reads the master's list next: of two lists that wait it takes the later one.
    """

    def __init__(self, way, name=ROGUE):
        super().__init__(name, OUT)
        self._way, self._came = way, 0.0

    def __enter__(self):
        self._come()
        return self

    def insist(self):
        """Come again if whom it told of itself has hung up, or does not connect."""
        is_late = time.monotonic() > self._came + _CONNECT_S
        if not self.has_subscriber and (self.first_connection or is_late):
            self._come()

    def _come(self):
        self._way(self)
        self._came = time.monotonic()


def ghost(node, *others):
    """Return an intruder that tells a node of itself and `others`, and nobody else."""
    return ReturningIntruder(lambda each: each.announce_to(node, *others))


def wait_until_found(scene, intruder, kind):
    """Wait for the alarm about this intruder, not about an earlier one."""

    def found():
        if not scene.alarmed(kind, intruder.uri):
            intruder.insist()
        return scene.alarmed(kind, intruder.uri)

    wait_for(found, what=f"the alarm, {kind}")

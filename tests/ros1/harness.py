"""A ROS 1 of the test's own: a master, processes, and questions about who is connected to whom."""

import os
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path
from weakref import WeakSet

from forked_nodes import fork_node

from rtron.demos.runtime.isolation import free_port
from rtron.errors import RTronError
from rtron.wire.ros1.xmlrpc import ros_call

HERE = Path(__file__).parent
NODES = HERE / "nodes"
SOURCE = HERE.parents[1] / "src"
ROS_PYTHON = "/usr/bin/python3"
LIMIT_S = 120.0
GRACE_S = 20.0
CALL_S = 10.0
_PAUSE_S, _LONGEST_PAUSE_S = 0.02, 0.1
_QUESTIONS = 8
"""A pause is no longer than this part of the wait so far: a test hardly waits longer for it."""
_LAST_LINES = 8
_STARTED = WeakSet()
_HASTE_S = 0.2
_LOADED = (
    *("genpy", "rosgraph.roslogging", "roslib.packages", "rosmaster.main", "roscpp.srv"),
    *("geometry_msgs.msg", "rosgraph_msgs.msg", "std_msgs.msg"),
)
"""What nodes in Python load, but rospy: it takes names from the command line as it is loaded."""
RTRON = Path(sys.executable).with_name("rtron")
"""The command `rtron` of the tests' Python."""
RTRON_MODULES = (
    *("rtron.cli.main", "rtron.cli.support.options", "rtron.cli.support.service_options"),
    *("rtron.guard.supervision.programs", "rtron.planning.plan_file.loader"),
)
"""What `rtron guard` loads before it becomes the supervisor, which loads all of its own again."""
_TOOLS = ("rosmaster", "rosnode", "rosparam", "rostopic")
"""Programs of ROS in Python, which are forked."""
_ORDERLY = (sys.executable, "roslaunch", "sh")
"""Programs that have others to end, or files to leave in order."""


class WaitTimeoutError(AssertionError):
    """What was waited for did not come."""


def wait_for(condition, limit_s=LIMIT_S, what="the condition", show=None):
    """Return what `condition()` gives once it is true; `show()` is what is there if it never is.

    Pauses grow with the wait: whoever is asked, a master or a node, has other things to do.
    """
    limit, pause, began = WaitLimit(what, limit_s), threading.Event(), time.monotonic()
    while not (found := condition()):
        limit.check(show or (lambda there=found: there))
        waited = time.monotonic() - began
        pause.wait(min(max(_PAUSE_S, waited / _QUESTIONS), _LONGEST_PAUSE_S))
    return found


class WaitLimit:
    """A limit on a wait that has a loop to turn meanwhile; all others are a `wait_for`."""

    def __init__(self, what="the condition", limit_s=LIMIT_S):
        self._what, self._limit_s = what, limit_s
        self._deadline = time.monotonic() + limit_s

    def check(self, show=lambda: None):
        """Raise WaitTimeoutError once the limit is over: what did not come, and what was there."""
        if time.monotonic() <= self._deadline:
            return
        there = show()
        seen = "" if there is None or there is False else f", there was {there!r}"
        raise WaitTimeoutError(f"{self._what}: not within {self._limit_s:g} s{seen}{_last_words()}")


def _last_words():
    """Return the last lines of each process that still runs."""
    running = sorted((each for each in _STARTED if not each.ended), key=lambda one: one.pid)
    return "".join(
        "\n".join([f"\n{each.log_path.name}:", *each.log.splitlines()[-_LAST_LINES:]])
        for each in running
    )


def lives(pid):
    """Tell whether a process is there, and no zombie: who collects an orphan may take its time."""
    try:
        stat = Path("/proc", str(pid), "stat").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return False
    return stat.rpartition(")")[2].split()[0] != "Z"


def is_open(path):
    """Return whether this process has a file open."""
    return any(each.exists() and each.samefile(path) for each in Path("/proc/self/fd").iterdir())


class Process:
    """A process with a group of its own, and what it says in a file.

    A script of Python is forked where there are modules that it may find loaded.
    """

    def __init__(self, command, environ, log, loaded=()):
        self.program = str(command[0])
        self.log_path = log
        with log.open("wb") as output:
            if loaded:
                self._popen = fork_node(self.program, loaded, command[1:], environ, log)
            else:
                self._popen = subprocess.Popen(
                    [str(word) for word in command],
                    env=environ,
                    stdin=subprocess.DEVNULL,
                    stdout=output,
                    stderr=subprocess.STDOUT,
                    start_new_session=True,
                )
        self.pid = self._popen.pid
        _STARTED.add(self)

    @property
    def log(self):
        return self.log_path.read_text(errors="replace")

    @property
    def ended(self):
        return self._popen.poll() is not None

    @property
    def code(self):
        return self._popen.poll()

    def tell(self, number):
        """Send a signal to the whole group, as a terminal does; nothing if it has ended.

        A forked process is collected by its server, so it may be gone before its end is read.
        """
        with suppress(ProcessLookupError):
            if not self.ended:
                os.killpg(self.pid, number)

    def stop(self, number=signal.SIGINT, grace_s=GRACE_S):
        """End the process, with force once its grace is over."""
        self.tell(number)
        try:
            self._popen.wait(grace_s)
        except subprocess.TimeoutExpired:
            self.tell(signal.SIGKILL)
            self._popen.wait()

    def hasten(self):
        """Let a guard that was told to end not wait until the robot is at rest: say it again."""
        for _ in range(3 if self.program == sys.executable else 0):
            with suppress(subprocess.TimeoutExpired):
                self._popen.wait(_HASTE_S)
            self.tell(signal.SIGINT)

    def hurry(self):
        """Let it, and what it starts, run before others: a guard in time is not stopped as late."""
        with suppress(PermissionError, ProcessLookupError):
            os.sched_setscheduler(self.pid, os.SCHED_RR, os.sched_param(1))

    def kill(self):
        """End the process without a word to the master."""
        self.stop(signal.SIGKILL)


class Ros1:
    """A master and the processes started beside it; all of them end with the context."""

    def __init__(self, folder):
        self.folder = folder
        self.uri = f"http://localhost:{free_port()}"
        kept = {name: text for name, text in os.environ.items() if not name.startswith("ROS_")}
        self.environ = kept | {
            "ROS_MASTER_URI": self.uri,
            "ROS_HOSTNAME": "localhost",
            "ROS_HOME": str(folder / "ros_home"),
            "ROS_LOG_DIR": str(folder / "ros_log"),
            "ROS_PACKAGE_PATH": str(folder),
            "PYTHONUNBUFFERED": "1",
            "PYTHONPATH": "",
        }
        self.master = None
        self._processes = []

    def __enter__(self):
        (self.folder / "ros_log").mkdir(parents=True, exist_ok=True)
        try:
            self.start_master()
        except BaseException:
            self._end()
            raise
        return self

    def __exit__(self, *_):
        self._end()

    def start_master(self):
        """Start a master on the test's port, again if it was killed."""
        self.master = self.spawn("rosmaster", "--core", "-p", self.uri.rpartition(":")[2])
        self.master.hurry()
        wait_for(lambda: self.ask(self.uri, "getPid") is not None, what="the master")

    def _end(self):
        """End all: at once what is a node and no more, which would take half a second to do it."""
        orderly = [process for process in self._processes if process.program in _ORDERLY]
        for process in self._processes:
            if process not in (self.master, *orderly):
                process.kill()
        for process in orderly:
            process.tell(signal.SIGINT)
        end = time.monotonic() + GRACE_S
        for process in orderly:
            process.hasten()
            process.stop(grace_s=max(0, end - time.monotonic()))
        for process in self._processes:
            process.kill()

    def spawn(self, *command, **environ):
        """Start a command; what it says goes to a file that its `log` gives."""
        log = self.folder / f"{len(self._processes)}_{Path(command[0]).name}.log"
        loaded = ()
        if command[0] in _TOOLS:
            command, loaded = (ROS_PYTHON, f"/usr/bin/{command[0]}", *command[1:]), _LOADED
        elif command[:2] == (sys.executable, RTRON):
            loaded = RTRON_MODULES
        elif command[0] == ROS_PYTHON and Path(command[1]).parent == NODES:
            loaded = _LOADED
        process = Process(command, self.environ | environ, log, loaded)
        self._processes.append(process)
        return process

    def node(self, script, name, *arguments):
        """Start a node of tests/ros1/nodes under a full name, with arguments and remaps."""
        return self.spawn(ROS_PYTHON, NODES / script, *arguments, *named(name))

    def rtron(self, *arguments):
        """Start `rtron` with the Python of the tests, before all others if we may."""
        process = self.spawn(sys.executable, RTRON, *arguments, PYTHONPATH=str(SOURCE))
        process.hurry()
        return process

    def run(self, *command, limit_s=LIMIT_S):
        """Run a command to its end and return what it said."""
        process = self.spawn(*command)
        wait_for(lambda: process.ended, limit_s, " ".join(map(str, command)))
        return process.log

    def ask(self, uri, method, *params):
        """Call a ROS API; None when there is no answer or it is no."""
        try:
            return ros_call(uri, method, "/test", *params, timeout=CALL_S)
        except RTronError:
            return None

    def state(self):
        """Return publishers, subscribers and services: each a mapping of names to node names."""
        sides = self.ask(self.uri, "getSystemState") or ([], [], [])
        return [{name: set(nodes) for name, nodes in side} for side in sides]

    def publishers(self, topic):
        return self.state()[0].get(topic, set())

    def subscribers(self, topic):
        return self.state()[1].get(topic, set())

    def uri_of(self, node):
        """Return a node's address; None if the master does not know it."""
        return self.ask(self.uri, "lookupNode", node)

    def has(self, *nodes):
        """Tell whether every one of the nodes answers."""
        return all((uri := self.uri_of(node)) and self.ask(uri, "getPid") for node in nodes)

    def wait_for_nodes(self, *nodes):
        wait_for(lambda: self.has(*nodes), what=f"nodes {', '.join(nodes)}")

    def connected(self, publisher, subscriber, topic):
        """Tell whether a publisher has a connection to a subscriber."""
        rows = self.ask(self.uri_of(publisher), "getBusInfo") or []
        return any(row[1] == subscriber and row[4] == topic for row in rows)

    def sent(self, node, topic):
        """Return how many messages a node has sent on a topic to those now connected."""
        stats = self.ask(self.uri_of(node), "getBusStats") or [[]]
        return sum(link[2] for row in stats[0] if row[0] == topic for link in row[2])

    def received(self, node, topic):
        """Return how many messages a node has received on a topic; 0 if it is not there."""
        uri = self.uri_of(node)
        stats = (uri and self.ask(uri, "getBusStats")) or [[], []]
        return sum(link[2] for row in stats[1] if row[0] == topic for link in row[1])


def named(name):
    """Return the arguments that give a node its full name."""
    namespace, _, last = name.rpartition("/")
    return (f"__name:={last}", f"__ns:={namespace or '/'}")

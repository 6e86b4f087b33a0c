"""A ROS 2 of the test's own: a domain that nobody else uses, and processes in it."""

import fcntl
import os
import signal
import sys
from contextlib import ExitStack, contextmanager
from itertools import cycle
from pathlib import Path
from tempfile import gettempdir

from harness import RTRON, RTRON_MODULES, Process, wait_for

_LOADED = ("rclpy", "rclpy.executors", "rclpy.action", "geometry_msgs.msg", "std_msgs.msg")
"""What nodes in Python load."""
NODES2 = Path(__file__).parent / "nodes"
_DOMAINS = range(1, 101)
_OF_TESTS = ("ROS_", "FASTDDS_", "FASTRTPS_")
_PROFILE = str(Path(__file__).parent / "lasting.xml")
LASTING = {f"FAST{kind}_DEFAULT_PROFILES_FILE": _PROFILE for kind in ("DDS", "RTPS")}
"""The environment of a node that, killed, stays in the domain for ten minutes: its lease."""


class Ros2:
    """A domain on this machine alone and the processes started in it; they end with the context.

    `python` is the interpreter of the tests, which has rclpy.
    """

    def __init__(self, folder):
        self.folder = folder
        self.domain = 0
        self.environ = {}
        self._processes = []
        self._stack = ExitStack()

    def __enter__(self):
        self.domain = self._stack.enter_context(reserve_domain())
        kept = {name: text for name, text in os.environ.items() if not name.startswith(_OF_TESTS)}
        self.environ = kept | {
            "ROS_DOMAIN_ID": str(self.domain),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "ROS_LOG_DIR": str(self.folder / "ros_log"),
            "PYTHONUNBUFFERED": "1",
        }
        return self

    def __exit__(self, *_):
        for process in self._processes:
            process.tell(signal.SIGINT)
        for process in self._processes:
            process.stop()
        self._stack.close()

    def spawn(self, *command, **environ):
        """Start a command; what it says goes to a file that its `log` gives."""
        log = self.folder / f"{len(self._processes)}_{Path(str(command[0])).name}.log"
        loaded = ()
        if command[0] == sys.executable and Path(command[1]).suffix == ".py":
            loaded = _LOADED
        elif command[:2] == (sys.executable, RTRON):
            loaded = RTRON_MODULES
        process = Process(command, self.environ | environ, log, loaded)
        self._processes.append(process)
        return process

    def node(self, script, *arguments, name="", remaps=(), **environ):
        """Start a node of tests/ros2/nodes, ready when it has said so; `remaps` are `a:=b`."""
        renamed = [f"__node:={name.rpartition('/')[2]}"] if name else []
        space = name.rpartition("/")[0]
        renamed += [f"__ns:={space}"] if space else []
        rules = [word for rule in (*renamed, *remaps) for word in ("-r", rule)]
        ros = ["--ros-args", *rules] if rules else []
        process = self.spawn(sys.executable, NODES2 / script, *arguments, *ros, **environ)
        wait_for(lambda: "ready" in process.log or process.ended, what=f"{script} {name}")
        assert not process.ended, process.log
        return process

    def rtron(self, *arguments):
        """Start `rtron` with the Python of the tests."""
        return self.spawn(sys.executable, RTRON, *arguments)


@contextmanager
def reserve_domain():
    """Give a domain id that no other test of this machine uses meanwhile."""
    first = os.getpid() % len(_DOMAINS)
    for domain in (_DOMAINS[(first + n) % len(_DOMAINS)] for n in cycle(_DOMAINS)):
        with Path(gettempdir(), f"rtron-test-domain-{domain}").open("w") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            yield domain
            return

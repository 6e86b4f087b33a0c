"""A guard with many nodes to audit: relays of topic_tools that listen to its output."""

import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path

from bench.common.plans import SUBSCRIBER, grcn
from bench.common.testbed import Testbed, last_errors, python, running
from bench.ros1.routes import PUBLISHER
from rtron.errors import RTronError
from rtron.planning.plan_file.writer import write_plan
from rtron.vocabulary import Plan, output_topic
from rtron.wire.ros1.xmlrpc import ros_call

TOPIC = "/cmd_vel"
OUT = output_topic(TOPIC)
_RELAY = "/usr/lib/topic_tools/relay"
_START_S = 60.0


@contextmanager
def run_audited_guard(
    testbed: Testbed, number: int, *, audit: bool
) -> Iterator[subprocess.Popen[str]]:
    """Run so many relays behind a guard, with its audit or without; give the guard's process."""
    names = [f"/audited_{index}" for index in range(number)]
    node = replace(grcn(TOPIC, [PUBLISHER]), successors=(SUBSCRIBER, *names))
    path = testbed.folder / "audited.yaml"
    path.write_text(write_plan(Plan(app="bench", grcn=(node,))), encoding="utf-8")
    with ExitStack() as stack:
        guard_command = python(
            "bench.ros1.guard_process", str(path), *(["--audit"] if audit else [])
        )
        guard = stack.enter_context(running(testbed, guard_command))
        for name in names:
            relay = [_RELAY, OUT, f"{name}_heard", f"__name:={name[1:]}"]
            stack.enter_context(running(testbed, relay, signal.SIGINT))
        _wait_for(testbed, number)
        yield guard


def processor_ns(pid: int) -> int:
    """Return the processor time that a process has used, all its threads together, ns."""
    threads = Path(f"/proc/{pid}/task").iterdir()
    return sum(int((each / "schedstat").read_text().split()[0]) for each in threads)


def _wait_for(testbed: Testbed, number: int) -> None:
    deadline = time.monotonic() + _START_S
    while time.monotonic() < deadline:
        if _subscriber_count(testbed.environ["ROS_MASTER_URI"]) >= number:
            return
        time.sleep(0.1)
    raise TimeoutError(f"the audited nodes do not start\n{last_errors(testbed)}")


def _subscriber_count(master: str) -> int:
    """Return how many nodes have subscribed the guard's output."""
    try:
        state = ros_call(master, "getSystemState", "/bench", timeout=5)
    except RTronError:
        return 0
    return len(dict(state[1]).get(OUT, []))

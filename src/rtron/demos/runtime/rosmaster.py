"""A ROS 1 master of our own."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from rtron.demos.runtime.polling import wait_for
from rtron.demos.runtime.processes import ProcessGroup
from rtron.errors import RTronError
from rtron.wire.ros1.xmlrpc import ros_call

_NAME = "/rtron_demo"
_LIMIT = 2.0


@contextmanager
def run_master(processes: ProcessGroup, environ: Mapping[str, str]) -> Iterator[None]:
    """Run a master at ROS_MASTER_URI of `environ` until the end of the block."""
    uri = environ["ROS_MASTER_URI"]
    command = ["rosmaster", "--core", "-p", uri.rpartition(":")[2]]
    with processes.running(command, environ):
        wait_for(lambda: _master_answers(uri), "the ROS master")
        yield


def _master_answers(uri: str) -> bool:
    try:
        ros_call(uri, "getPid", _NAME, timeout=_LIMIT)
    except RTronError:
        return False
    return True

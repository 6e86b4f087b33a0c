"""Which process the guard is: not the one that was started, which is its supervisor."""

from contextlib import suppress

from rtron.errors import RTronError
from rtron.vocabulary import GUARD_NODE
from rtron.wire.ros1.xmlrpc import ros_call

_TIMEOUT_S = 2.0


def guard_pid(master: str) -> int:
    """Return the guard's process; 0 while it does not answer."""
    with suppress(RTronError):
        uri = ros_call(master, "lookupNode", "/bench", GUARD_NODE, timeout=_TIMEOUT_S)
        return int(ros_call(uri, "getPid", "/bench", timeout=_TIMEOUT_S))
    return 0

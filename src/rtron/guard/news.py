"""Whether an event is news, or an old one that is sent again and again."""

from collections.abc import Callable

from rtron.errors import WireError
from rtron.policies.velocity_limit.frame_rate import NO_STAMP


class StampFilter:
    """Knows the stamp of the last event of one publisher.

    That a message arrives does not make what it says fresh: a node that repeats its last message
    looks alive. Without a stamp, or with stamp 0, each message is news.
    """

    def __init__(self, stamp: Callable[[bytes], int]) -> None:
        self._stamp = stamp
        self._last_stamp = NO_STAMP

    def is_new(self, message: bytes) -> bool:
        """Tell whether a message is not the last one once more; one without a head is new."""
        try:
            stamp = self._stamp(message)
        except WireError:
            return True
        is_repeated = stamp == self._last_stamp != NO_STAMP
        self._last_stamp = stamp
        return not is_repeated

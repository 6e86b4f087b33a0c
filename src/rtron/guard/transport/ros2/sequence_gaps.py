"""Messages that did not arrive, by the numbers that DDS gives each publisher's messages."""

_MAX_PUBLISHERS = 4096


class SequenceGaps:
    """Tells how many messages of a publisher, by its GID, are missing before one that arrived.

    What was sent before the first message that was seen may have been sent before anybody listened.
    It is missing only as far as messages were replaced in the queue, unread: `replaced` tells that.
    """

    def __init__(self) -> None:
        self._expected: dict[bytes, int] = {}
        self._newest: bytes | None = None
        self._explained = 0

    def see(self, gid: bytes, number: int | None) -> None:
        """Note a message that waits: if it is never passed on, it counts as missing."""
        if number is not None and len(self._expected) < _MAX_PUBLISHERS:
            self._expect_from(gid, number)

    def missing_before(self, gid: bytes, number: int | None) -> int:
        """Return how many are missing before a message that is passed on, and expect the next."""
        if number is None:
            return 0
        expected = self._expect_from(gid, number)
        self._expected[gid] = max(expected, number + 1)
        missing = max(0, number - expected)
        self._explained += missing
        return missing

    def replaced(self, count: int) -> tuple[bytes | None, int]:
        """Return the newest publisher, and how many of its first messages were replaced.

        `count` is how many of all publishers were replaced until the queue was empty.
        """
        newest, rest = self._newest, max(0, count - self._explained)
        self._newest, self._explained = None, 0
        return newest, rest

    def forget(self, gid: bytes) -> None:
        """Forget a publisher that has left."""
        self._expected.pop(gid, None)

    def _expect_from(self, gid: bytes, number: int) -> int:
        if gid not in self._expected:
            self._expected[gid] = number
            self._newest = gid
        return self._expected[gid]

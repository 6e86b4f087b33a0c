"""Messages that tell which of their publisher's words they are."""


class NumberedMessage(bytes):
    """A message with its publisher's number of it.

    `writer` names the publisher and no other, not even the one in its place after a restart;
    `number` grows with each of its messages, and one that it sends again has the number it had.
    `source_time` is when it was said first, ns of its publisher's wall clock, 0 if nobody knows.
    """

    writer: str
    number: int
    source_time: int

    @classmethod
    def of(
        cls, message: bytes, writer: str, number: int, source_time: int = 0
    ) -> "NumberedMessage":
        """Return a message that knows its number."""
        numbered = cls(message)
        numbered.writer, numbered.number, numbered.source_time = writer, number, source_time
        return numbered

"""Messages that tell which of their publisher's words they are."""


class Numbered(bytes):
    """A message with its publisher's number of it.

    `writer` names the publisher and no other, not even the one in its place after a restart;
    `number` grows with each of its messages, and one that it sends again has the number it had.
    `said` is when it was said first, ns of its publisher's wall clock, 0 if nobody knows.
    """

    writer: str
    number: int
    said: int

    @classmethod
    def of(cls, message: bytes, writer: str, number: int, said: int = 0) -> "Numbered":
        """Return a message that knows its number."""
        made = cls(message)
        made.writer, made.number, made.said = writer, number, said
        return made

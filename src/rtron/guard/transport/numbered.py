"""Messages that tell which of their publisher's words they are."""


class Numbered(bytes):
    """A message with its publisher's number of it.

    `writer` names the publisher and no other, not even the one in its place after a restart;
    `number` grows with each of its messages, and one that it sends again has the number it had.
    """

    writer: str
    number: int

    @classmethod
    def of(cls, message: bytes, writer: str, number: int) -> "Numbered":
        """Return a message that knows its number."""
        made = cls(message)
        made.writer, made.number = writer, number
        return made

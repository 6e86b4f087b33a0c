"""Names that strangers choose, made safe for a log: one line of bounded length."""

_MAX_LENGTH = 200


def printable(text: str) -> str:
    """Return a text cut short, with escapes for characters that cannot be printed.

    Escapes are longer than what they stand for, so the result is cut again.
    """
    short = text[:_MAX_LENGTH]
    return short if short.isprintable() else ascii(short)[1:-1][:_MAX_LENGTH]

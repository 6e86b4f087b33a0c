"""What strangers call themselves, fit for a log: on one line, and not too long."""

_MAX_LENGTH = 200


def printable(text: str) -> str:
    """Return a text cut short, with escapes in the place of what cannot be printed."""
    short = text[:_MAX_LENGTH]
    return short if short.isprintable() else ascii(short)[1:-1]

"""What strangers call themselves, fit for a log: on one line, and not too long."""

_LONGEST = 200


def shown(text: str) -> str:
    """Return a text cut short, with escapes in the place of what cannot be printed."""
    short = text[:_LONGEST]
    return short if short.isprintable() else ascii(short)[1:-1]

"""Secrets: made here, told once, and kept as hashes only."""

import hashlib
import secrets

_BYTES = 32
_READABLE = "abcdefghijkmnpqrstuvwxyz23456789"
_LETTERS = 24
_GROUP = 6


def new_secret(prefix: str = "") -> str:
    """Return a secret of 256 bits that fits into a header."""
    return prefix + secrets.token_urlsafe(_BYTES)


def digest(secret: str) -> str:
    """Return what is kept of a secret. Of 256 random bits a plain SHA-256 tells nothing."""
    return hashlib.sha256(secret.encode()).hexdigest()


def new_password() -> str:
    """Return a password of 120 bits, in groups that a person can type from another screen."""
    letters = [secrets.choice(_READABLE) for _ in range(_LETTERS)]
    return "-".join("".join(letters[at : at + _GROUP]) for at in range(0, _LETTERS, _GROUP))

"""Secrets and passwords that are drawn at random."""

import hashlib
import secrets

_SECRET_BYTES = 32
READABLE_CHARACTERS = "abcdefghijkmnpqrstuvwxyz23456789"
_PASSWORD_LENGTH = 24
_GROUP_LENGTH = 6


def new_secret(prefix: str = "") -> str:
    """Return a secret of 256 bits that fits into a header."""
    return prefix + secrets.token_urlsafe(_SECRET_BYTES)


def secret_digest(secret: str) -> str:
    """Return what is kept of a secret. Of 256 random bits a plain SHA-256 tells nothing."""
    return hashlib.sha256(secret.encode()).hexdigest()


def new_password() -> str:
    """Return a password of 120 bits, in groups that a person can type from another screen."""
    letters = [secrets.choice(READABLE_CHARACTERS) for _ in range(_PASSWORD_LENGTH)]
    return "-".join(
        "".join(letters[at : at + _GROUP_LENGTH])
        for at in range(0, _PASSWORD_LENGTH, _GROUP_LENGTH)
    )

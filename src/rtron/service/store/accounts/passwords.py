"""Passwords: hashed with argon2id (RFC 9106), always with the same effort, few at a time."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from threading import BoundedSemaphore

from argon2 import PasswordHasher
from argon2.exceptions import Argon2Error, InvalidHashError

from rtron.service.domain.errors import TooManyError

_AT_A_TIME = 2
_WAITING = 8

_hasher = PasswordHasher()
_working = BoundedSemaphore(_AT_A_TIME)
_admitted = BoundedSemaphore(_WAITING)


def hash_password(password: str) -> str:
    """Return the hash to keep; TooManyError if too many are being made."""
    with _place():
        return _hasher.hash(password)


def matches(password: str, hashed: str | None) -> bool:
    """Tell whether a password is the one of a hash; None, nobody's, takes as long as any other."""
    with _place():
        try:
            return _hasher.verify(hashed or _nobody(), password) and hashed is not None
        except (Argon2Error, InvalidHashError):
            return False


@cache
def _nobody() -> str:
    return _hasher.hash("nobody")


@contextmanager
def _place() -> Iterator[None]:
    """Each hash takes 64 MiB and a core: a crowd of strangers must not get them all."""
    if not _admitted.acquire(blocking=False):
        raise TooManyError("too many logins at this moment", help="try again in a second")
    try:
        with _working:
            yield
    finally:
        _admitted.release()

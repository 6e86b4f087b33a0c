"""Passwords: hashed with argon2id (RFC 9106), always with the same effort, few at a time."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from threading import BoundedSemaphore

from argon2 import PasswordHasher
from argon2.exceptions import Argon2Error, InvalidHashError

from rtron.service.domain.errors import TooManyRequestsError

_MAX_CONCURRENT = 2
_MAX_ADMITTED = 8

_hasher = PasswordHasher()
_hashing_slots = BoundedSemaphore(_MAX_CONCURRENT)
_admission_slots = BoundedSemaphore(_MAX_ADMITTED)


def hash_password(password: str) -> str:
    """Return the hash to keep; TooManyRequestsError if too many are being made."""
    with _hashing_slot():
        return _hasher.hash(password)


def verify_password(password: str, hashed: str | None) -> bool:
    """Tell whether a password is the one of a hash; None, nobody's, takes as long as any other."""
    with _hashing_slot():
        try:
            return _hasher.verify(hashed or _dummy_hash(), password) and hashed is not None
        except (Argon2Error, InvalidHashError):
            return False


@cache
def _dummy_hash() -> str:
    return _hasher.hash("nobody")


@contextmanager
def _hashing_slot() -> Iterator[None]:
    """Each hash takes 64 MiB and a core: a crowd of strangers must not get them all."""
    if not _admission_slots.acquire(blocking=False):
        raise TooManyRequestsError("too many logins at this moment", help="try again in a second")
    try:
        with _hashing_slots:
            yield
    finally:
        _admission_slots.release()

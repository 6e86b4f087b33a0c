"""Passwords: hashed with argon2id (RFC 9106), always with the same effort, few at a time.

The threads that hash come last for the processor, so that a crowd of guessers delays no stop.
"""

import os
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from threading import BoundedSemaphore
from typing import TypeVar

from argon2 import PasswordHasher
from argon2.exceptions import Argon2Error, InvalidHashError

from rtron.service.domain.errors import TooManyRequestsError

_MAX_CONCURRENT = 2
_MAX_ADMITTED = 8
_NICENESS = 10
_T = TypeVar("_T")


def _come_last() -> None:
    if sys.platform == "linux":  # where threads have priorities of their own
        os.nice(_NICENESS)


_hasher = PasswordHasher()
_threads = ThreadPoolExecutor(_MAX_CONCURRENT, "passwords", _come_last)
_admission_slots = BoundedSemaphore(_MAX_ADMITTED)


def hash_password(password: str) -> str:
    """Return the hash to keep; TooManyRequestsError if too many are being made."""
    return _run(lambda: _hasher.hash(password))


def verify_password(password: str, hashed: str | None) -> bool:
    """Tell whether a password is the one of a hash; None, nobody's, takes as long as any other."""

    def is_right() -> bool:
        try:
            return _hasher.verify(hashed or _dummy_hash(), password) and hashed is not None
        except (Argon2Error, InvalidHashError):
            return False

    return _run(is_right)


@cache
def _dummy_hash() -> str:
    return _hasher.hash("nobody")


def _run(work: Callable[[], _T]) -> _T:
    """Each hash takes 64 MiB and a core: a crowd of strangers must not get them all."""
    if not _admission_slots.acquire(blocking=False):
        raise TooManyRequestsError("too many logins at this moment", help="try again in a second")
    try:
        return _threads.submit(work).result()
    finally:
        _admission_slots.release()

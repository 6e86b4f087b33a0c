"""Time-based one-time codes (TOTP, RFC 6238), as apps on phones show them: 6 digits, every 30 s."""

import base64
import hmac
from urllib.parse import quote, urlencode

from cryptography.hazmat.primitives.hashes import SHA1
from cryptography.hazmat.primitives.twofactor.totp import TOTP

from rtron.vocabulary import SECOND

DIGITS = 6
STEP_S = 30
_ISSUER = "RTron"


def otpauth_uri(key: str, user: str) -> str:
    """Return what a phone reads from a QR code, for a key in base 32."""
    values = {"secret": key, "issuer": _ISSUER, "digits": DIGITS, "period": STEP_S}
    return f"otpauth://totp/{quote(f'{_ISSUER}:{user}')}?{urlencode(values)}"


def new_key(random: bytes) -> str:
    """Return random bytes as a key in base 32, without padding."""
    return base64.b32encode(random).decode().rstrip("=")


def code_at(key: str, step: int) -> str:
    """Return the code of a step, which is STEP_S long and counted since 1970."""
    return _totp(key).generate(step * STEP_S).decode()


def step_at(now: int) -> int:
    """Return the step of a time (wall clock, ns)."""
    return now // (STEP_S * SECOND)


def matching_step(key: str, code: str, now: int, used: int) -> int | None:
    """Return the step whose code this is: that of `now`, or one beside it for a clock that differs.

    Steps up to `used` are over: each code counts once.
    """
    at = step_at(now)
    for step in range(max(at - 1, used + 1), at + 2):
        if hmac.compare_digest(code_at(key, step).encode(), code.encode()):
            return step
    return None


def _totp(key: str) -> TOTP:
    padded = key + "=" * (-len(key) % 8)
    # Apps on phones know no other hash; HMAC does not need it to be free of collisions.
    return TOTP(base64.b32decode(padded), DIGITS, SHA1(), STEP_S)  # noqa: S303

"""Why the collector closes a guard's connection: the codes of the link (RFC 6455, section 7.4)."""

from enum import IntEnum

_MAX_REASON_BYTES = 120
"""A close frame holds 123 bytes of reason."""


class CloseCode(IntEnum):
    """What a guard is told when its connection ends; it may always connect again."""

    GOING_AWAY = 1001
    TOO_BIG = 1009
    FAILED = 1011
    MALFORMED = 4400
    NO_TOKEN = 4401
    WRONG_ROBOT = 4403
    TOO_SLOW = 4408
    REPLACED = 4409
    REFUSED = 4422
    PROTOCOL = 4426
    TOO_MUCH = 4429


class CloseConnectionError(Exception):
    """Ends the connection with this code; `reason` is told to the guard."""

    def __init__(self, code: CloseCode, reason: str) -> None:
        super().__init__(reason)
        self.code = code
        self.reason = reason.encode()[:_MAX_REASON_BYTES].decode(errors="ignore")

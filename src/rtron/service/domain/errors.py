"""Why the service does not do what it was asked for; each is one status of HTTP.

InputError (422) and the rest of RTron's errors keep their meaning; these say what only a service
can: who asks, how often, and what has happened meanwhile.
"""

from rtron.errors import RTronError


class AuthenticationError(RTronError):
    """Nobody is logged in, or the name, the password or the token is wrong (401)."""


class ForbiddenError(RTronError):
    """The one who asks may not do that (403)."""


class NotFoundError(RTronError):
    """There is no such robot, node, user, … (404)."""


class ConflictError(RTronError):
    """Something has changed meanwhile, or exists already (409)."""


class TooManyRequestsError(RTronError):
    """Asked for too often, or too much at a time (429); try again after `retry_after` seconds."""

    def __init__(self, message: str, *, retry_after: float = 1.0, help: str = "") -> None:
        super().__init__(message, help=help)
        self.retry_after = retry_after

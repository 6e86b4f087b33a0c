"""What clients ask for and a person must approve first: each request once, word for word.

A client asks by trying: it is refused, and its request waits for a person. Once that has approved
it, the client sends the same again, and it passes once. Times are ns.
"""

import hashlib
import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import count
from secrets import token_hex

from rtron.errors import WireError
from rtron.vocabulary import SECOND

MAX_WAITING = 8
"""So many requests of one client may wait."""
MAX_CONTENT = 4096
"""The longest content that a person can be expected to read, characters."""
MAX_SHOWN = 16
"""So many requests are listed for persons, the first ones of each client before its others."""
WAITS_FOR = 600 * SECOND
HOLDS_FOR = 60 * SECOND
"""How long an answer of a person holds."""


@dataclass(slots=True)
class ApprovalRequest:
    """What a client wants to send, and what a person has said to it.

    No other request has its `digest`, of this bridge or another life of it.
    """

    number: int
    digest: str
    client: str
    what: str
    content: str
    until: int
    answered_by: str = ""
    is_approved: bool = False


class Approvals:
    """The requests of all clients of a bridge, which outlast their connections."""

    def __init__(self) -> None:
        self._life = token_hex(16)
        self._numbers = count(1)
        self._requests: dict[int, ApprovalRequest] = {}

    def check(self, client: str, what: str, content: object, now: int) -> None:
        """Use up an approval; WireError if there is none, and a person is asked for one."""
        text = json.dumps(content, sort_keys=True, separators=(",", ":"))
        if len(text) > MAX_CONTENT:
            reason = f"longer than {MAX_CONTENT} characters, which nobody could approve"
            raise WireError(f"{what}: {reason}")
        self._forget_old(now)
        own = [each for each in self._requests.values() if each.client == client]
        found = next((x for x in own if (x.what, x.content) == (what, text)), None)
        if found is None:
            raise WireError(self._ask(client, what, text, len(own), now))
        if not found.answered_by:
            raise WireError(f"{what}: {_waits(found)}")
        if not found.is_approved:
            raise WireError(f"{what}: {found.answered_by} has refused request {found.number}")
        del self._requests[found.number]

    def waiting(self, now: int) -> list[ApprovalRequest]:
        """Return the requests that nobody has answered, the oldest first."""
        self._forget_old(now)
        return [each for each in self._requests.values() if not each.answered_by]

    def shown(self, now: int) -> Sequence[ApprovalRequest]:
        """Return some of those that wait: a client with many hides none of another one."""
        places: Counter[str] = Counter()
        order = []
        for each in self.waiting(now):
            order.append((places[each.client], each.number, each))
            places[each.client] += 1
        return [each for *_, each in sorted(order)[:MAX_SHOWN]]

    def find(self, digest: str, now: int) -> ApprovalRequest:
        """Return the request of a digest; WireError if it does not wait, or no more."""
        found = next((each for each in self.waiting(now) if each.digest == digest), None)
        if found is None:
            raise WireError("this request does not wait any more: it is answered, or over")
        return found

    def answer(self, number: int, by: str, now: int, *, is_approved: bool) -> ApprovalRequest:
        """Approve or refuse a request as a person; WireError if none of this number waits."""
        found = next((each for each in self.waiting(now) if each.number == number), None)
        if found is None:
            raise WireError(f"no request {number} waits for anybody")
        found.answered_by, found.is_approved, found.until = by, is_approved, now + HOLDS_FOR
        return found

    def _ask(self, client: str, what: str, content: str, waiting: int, now: int) -> str:
        if waiting >= MAX_WAITING:
            return f"{what}: {waiting} requests of yours wait for a person already"
        number = next(self._numbers)
        digest = _digest(self._life, number, client, what, content)
        request = ApprovalRequest(number, digest, client, what, content, now + WAITS_FOR)
        self._requests[number] = request
        return f"{what}: {_waits(request)}"

    def _forget_old(self, now: int) -> None:
        self._requests = {n: each for n, each in self._requests.items() if now < each.until}


def _digest(*parts: str | int) -> str:
    return hashlib.sha256(json.dumps(parts).encode()).hexdigest()


def _waits(request: ApprovalRequest) -> str:
    return f"request {request.number} waits until a person approves it; then send the same again"

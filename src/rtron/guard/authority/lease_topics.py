"""The topics of a lease: commanders ask for it on one, and hear the answers and who holds it.

All of them are std_msgs/String, so that no node needs messages of RTron. A request is a word and
what belongs to it: `acquire why`, `renew`, `release why`, `offer NODE`, `accept`, `take_over why`.
Answers and the status are JSON. Who asks is the publisher's node, as the middleware knows it; a
request that the middleware sends again (latched) is none.
"""

import json
import logging
from collections import defaultdict, deque
from collections.abc import Callable, Mapping
from functools import partial

from rtron.errors import WireError, suggestion
from rtron.guard.authority.lease_controller import LeaseController
from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.core.printable import printable
from rtron.guard.core.report_messages import STRING, read_string, string_message
from rtron.guard.settings.local_overrides import single_line
from rtron.guard.transport.common.protocol import (
    InputOptions,
    MessageHandler,
    Output,
    Peer,
    Transport,
)
from rtron.policies.authority.command_lease import CommandLease, LeaseAnswer
from rtron.vocabulary import GUARD_NODE, SECOND, lease_topic

log = logging.getLogger(__name__)

MAX_REQUEST = 1024
"""The longest request, bytes."""
MAX_REQUESTS = 10
"""How often a commander may ask for a lease in a second; the shortest ttl needs four renewals."""
_MAX_NAME = 128

REQUESTS: Mapping[str, Callable[[CommandLease, str, str, int], LeaseAnswer]] = {
    "acquire": lambda lease, who, text, now: lease.acquire(who, now, text),
    "renew": lambda lease, who, text, now: lease.renew(who, now),
    "release": lambda lease, who, text, now: lease.release(who, now, text),
    "offer": lambda lease, who, text, now: lease.offer(who, text, now),
    "accept": lambda lease, who, text, now: lease.accept(who, now),
    "take_over": lambda lease, who, text, now: lease.take_over(who, now, text),
}
"""What can be asked for: takes the lease, who asks, the text behind the word, and the time (ns)."""


class LeaseTopics:
    """Serves the topics of all leases of a guard."""

    def __init__(self, controller: LeaseController, transport: Transport) -> None:
        self._controller = controller
        self._transport = transport
        self._log_throttle = LogThrottle()
        self._request_times: defaultdict[tuple[str, str], deque[int]] = defaultdict(
            partial(deque, maxlen=MAX_REQUESTS)
        )
        self._answers: dict[str, Output] = {}
        self._statuses: dict[str, Output] = {}

    def open(self) -> None:
        """Join the graph, and say that nobody holds anything yet."""
        self._controller.change_listeners.append(lambda lease, _why: self._publish_status(lease))
        for lease in self._controller.leases.values():
            self._answers[lease.name] = self._advertise(lease.name, "answer")
            self._statuses[lease.name] = self._advertise(lease.name, "status")
            self._publish_status(lease)
            self._subscribe(lease)

    def close(self) -> None:
        """Do nothing: the transport leaves the graph."""

    def _advertise(self, lease: str, part: str) -> Output:
        output = self._transport.advertise(GUARD_NODE, lease_topic(lease, part), STRING.type)
        output.learn_type(STRING)
        return output

    def _subscribe(self, lease: CommandLease) -> None:
        options = InputOptions(is_command=lambda peer: True, publishers=lease.commander_names)
        topic, connect = lease_topic(lease.name, "request"), partial(self._connect, lease)
        self._transport.subscribe(GUARD_NODE, topic, STRING.type, connect, options)

    def _connect(self, lease: CommandLease, peer: Peer) -> MessageHandler | None:
        refusal = _peer_refusal(lease, peer)
        if not refusal:
            return partial(self._on_request, lease, peer.node)
        name = printable(peer.node)[:_MAX_NAME]
        if self._log_throttle.allows(name, self._transport.now()):
            log.warning("lease %s: %s may ask for nothing: %s", lease.name, name, refusal)
            self._answer(lease.name, name, "", LeaseAnswer(granted=False, reason=refusal))
        return None

    def _on_request(self, lease: CommandLease, who: str, message: bytes) -> None:
        if self._is_flooded(lease.name, who):
            return
        try:
            text = read_string(self._transport.encoding, message, MAX_REQUEST)
        except WireError as error:
            text, answer = "", LeaseAnswer(granted=False, reason=f"no request: {error}")
        else:
            answer = self._handle(lease, who, single_line(text))
        word = text.split(maxsplit=1)[0] if text.strip() else ""
        if word != "renew" or not answer.granted:
            self._answer(lease.name, who, printable(word)[:_MAX_NAME], answer)

    def _is_flooded(self, lease: str, who: str) -> bool:
        """Tell whether a commander asks too often, which is answered once a second and not read."""
        now, times = self._transport.now(), self._request_times[lease, who]
        if len(times) < MAX_REQUESTS or now - times[0] >= SECOND:
            times.append(now)
            return False
        if self._log_throttle.allows((lease, who), now):
            reason = f"more than {MAX_REQUESTS} requests a second: the others are not read"
            log.warning("lease %s: %s: %s", lease, who, reason)
            self._answer(lease, who, "", LeaseAnswer(granted=False, reason=reason))
        return True

    def _handle(self, lease: CommandLease, who: str, text: str) -> LeaseAnswer:
        word, _, rest = text.partition(" ")
        act = REQUESTS.get(word)
        if act is None:
            reason = f"nothing is called {word!r}: {suggestion(word, sorted(REQUESTS))}"
            return LeaseAnswer(granted=False, reason=reason)
        ask = partial(_ask, act, who, rest.strip())
        return self._controller.request(lease.name, f"{word} by {who}", ask)

    def _answer(self, lease: str, to: str, request: str, answer: LeaseAnswer) -> None:
        values = {
            "to": to,
            "request": request,
            "granted": answer.granted,
            "reason": answer.reason,
        }
        self._publish(self._answers[lease], values)

    def _publish_status(self, lease: CommandLease) -> None:
        values = self._controller.describe(lease.name)
        text = string_message(self._transport.encoding, json.dumps(values))
        self._statuses[lease.name].publish(text, latched_by=GUARD_NODE)

    def _publish(self, output: Output, values: Mapping[str, object]) -> None:
        output.publish(string_message(self._transport.encoding, json.dumps(values)))


def _ask(
    act: Callable[[CommandLease, str, str, int], LeaseAnswer],
    who: str,
    text: str,
    lease: CommandLease,
    now: int,
) -> LeaseAnswer:
    return act(lease, who, text, now)


def _peer_refusal(lease: CommandLease, peer: Peer) -> str:
    """Return why nobody listens to a publisher of requests, "" if it is a commander."""
    if peer.node not in lease.commander_names:
        return f"it is no commander of {lease.name}: the plan does not name it"
    if not peer.verified:
        return "another node owns its name, or nobody knows whose it is"
    return "its requests are latched: an old one would come again" if peer.latching else ""

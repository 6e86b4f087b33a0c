"""Follow events: the service's live WebSocket, and its pages for events that were missed."""

import asyncio
import json
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from typing import Any

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import (
    ConnectionClosed,
    ConnectionClosedOK,
    InvalidHandshake,
    InvalidStatus,
)

from rtron.errors import InputError, SourceError
from rtron.workflows.service_client import SecurityServiceClient

_PATIENCE_S = 10
_PAUSE_S = 1.0
_LONGEST = 1 << 22
_PAGE = 1000
_REFUSED = (401, 403)
_POLICY_VIOLATION = 1008
_LEVELS = ("info", "warning", "error")

Event = Mapping[str, Any]
EventFilter = Mapping[str, str | None]


def follow_events(
    client: SecurityServiceClient,
    event_filter: EventFilter,
    last: int,
    on_lost: Callable[[Exception], None],
) -> Iterator[Event]:
    """Yield the events after the id `last` that fit `event_filter`, each once; without end.

    It reconnects to a service that is away, which `on_lost` is told; InputError if the token is no
    longer valid.
    """
    follower = _EventFollower(client, event_filter, last, on_lost)
    while True:
        yield from follower.while_connected()
        time.sleep(_PAUSE_S)


@dataclass(slots=True)
class _EventFollower:
    """Yields events once each: `last` is the id of the newest one that was yielded or skipped."""

    client: SecurityServiceClient
    event_filter: EventFilter
    last: int
    on_lost: Callable[[Exception], None]

    def while_connected(self) -> Iterator[Event]:
        """Yield events until the connection to the service is lost."""
        try:
            with _messages(self.client) as messages:
                yield from self._events(messages)
        except (SourceError, OSError, InvalidHandshake, ConnectionClosed, TimeoutError) as error:
            _raise_if_unauthorized(error)
            self.on_lost(error)

    def _events(self, messages: Iterator[str | bytes]) -> Iterator[Event]:
        """Yield missed events, then live ones; of a burst the service sends only some live."""
        yield from self._missed_events()
        for event in _live_events(messages):
            if event["id"] > self.last + 1:
                yield from self._missed_events()
            if event["id"] > self.last:
                self.last = event["id"]
                if _matches(event, self.event_filter):
                    yield event

    def _missed_events(self) -> Iterator[Event]:
        """Yield the stored events after the last one, oldest first."""
        newest = self.client.get("events", limit=1)["events"]
        end = max(self.last, newest[0]["id"]) if newest else self.last
        after = self.last or None
        missed = stored_events(self.client, **self.event_filter, after=after, before=end + 1)
        for event in reversed(list(missed)):
            self.last = event["id"]
            yield event
        self.last = end


@contextmanager
def _messages(client: SecurityServiceClient) -> Iterator[Iterator[str | bytes]]:
    """Connect, and give the messages until the service closes; ConnectionClosed if it is lost.

    websockets' synchronous client reads and writes in two threads, for which Python's TLS has no
    lock before 3.13: one request in a thousand was lost.
    """
    with closing(asyncio.new_event_loop()) as loop:
        socket = loop.run_until_complete(_connect(client))
        try:
            yield _until_closed(lambda: _receive(loop, socket))
        finally:
            loop.run_until_complete(socket.close())


def _receive(loop: asyncio.AbstractEventLoop, socket: ClientConnection) -> str | bytes:
    """Return the next message; an interrupt cancels the wait."""
    task = loop.create_task(socket.recv())
    try:
        return loop.run_until_complete(task)
    finally:
        task.cancel()


async def _connect(client: SecurityServiceClient) -> ClientConnection:
    return await connect(
        client.live_url,
        additional_headers=client.auth_headers,
        ssl=client.tls_context,
        open_timeout=_PATIENCE_S,
        max_size=_LONGEST,
        proxy=None,
    )


def _until_closed(receive: Callable[[], str | bytes]) -> Iterator[str | bytes]:
    with suppress(ConnectionClosedOK):
        while True:
            yield receive()


def stored_events(client: SecurityServiceClient, **query: object) -> Iterator[Event]:
    """Yield the stored events that fit a query of the API, the newest first."""
    while True:
        page = client.get("events", **query, limit=_PAGE)
        yield from page["events"]
        if page["next"] is None:
            return
        query["before"] = page["next"]


def _live_events(messages: Iterator[str | bytes]) -> Iterator[Event]:
    for data in messages:
        message = json.loads(data)
        if message["type"] == "event":
            yield message["event"]


def _matches(event: Event, event_filter: EventFilter) -> bool:
    least = _LEVELS.index(event_filter["level"] or _LEVELS[0])
    if _LEVELS.index(event["level"]) < least:
        return False
    return all(event_filter[key] in (None, event[key]) for key in ("robot", "node", "kind"))


def _raise_if_unauthorized(error: Exception) -> None:
    """Raise InputError if the service refused the token: a new connection does not help."""
    status = error.response.status_code if isinstance(error, InvalidStatus) else 0
    closed = error.rcvd.code if isinstance(error, ConnectionClosed) and error.rcvd else 0
    if status in _REFUSED or closed == _POLICY_VIOLATION:
        help = "is the token revoked, or is it a guard's?"
        raise InputError("the service refuses to send live events", help=help) from None

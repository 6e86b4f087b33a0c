"""What a guard leaves to the one that takes its place: a small JSON document, kept up to date.

Written at once and whole: what was kept is there for the next guard even if this one is killed by
the next instruction.
"""

import json
import logging
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from rtron.guard.core.event_loop import BackgroundWorker, EventLoop
from rtron.guard.system.state_folder import master_file_name
from rtron.policies.policy import Policy
from rtron.policies.state_transfer import LeaseState, PolicyState

log = logging.getLogger(__name__)

MOST_BYTES = 1 << 18
"""The longest handover state, bytes of JSON."""
INTRUSIONS = "intrusions"
"""The key of what intruders have stopped."""
STOPS = "stops"
"""The key of what persons and buttons have stopped."""
RESERVED_BYTES = 1 << 16
"""The last bytes, which nothing but the intrusions and the stops may use."""


class HandoverState:
    """Values by key: `inherited` reads those of the guard before, `store` writes for the next one.

    Without a supervisor the values stay in memory and end with the process.
    """

    def __init__(
        self, inherited: bytes = b"", write: Callable[[bytes], object] = lambda document: None
    ) -> None:
        """`inherited` is the last guard's document; `write` stores one of at most `MOST_BYTES`."""
        self.last_seen_at = 0
        """When the guard before last ran, ns of the wall clock, 0 if unknown."""
        self._write = write
        self._inherited = _values(inherited)
        self._stored = {key: _member(key, value) for key, value in self._inherited.items()}
        self._length = sum(map(len, self._stored.values()))

    def inherited(self, key: str) -> Any:  # noqa: ANN401 - any JSON value
        """Return the value that the guard before stored under a key, None if there is none."""
        return self._inherited.get(key)

    def store(self, key: str, value: object) -> None:
        """Store a JSON value for the next guard, in place of the key's value before.

        A value that makes the document too long is not stored, and the old one goes all the same:
        it would be wrong.
        """
        self._drop_member(key)
        if value is not None:
            self._add_member(key, _member(key, value))
        self._write(b"{" + b",".join(self._stored.values()) + b"}")

    def _drop_member(self, key: str) -> None:
        self._length -= len(self._stored.pop(key, b""))

    def _add_member(self, key: str, member: bytes) -> None:
        most = MOST_BYTES if key in (INTRUSIONS, STOPS) else MOST_BYTES - RESERVED_BYTES
        if self._length + len(member) + len(self._stored) + len("{}") > most:
            log.warning("%s is not handed over to the next guard: it is too long", key)
            return
        self._stored[key] = member
        self._length += len(member)


def _member(key: str, value: object) -> bytes:
    return f"{json.dumps(key)}:{json.dumps(value)}".encode()


def _values(document: bytes) -> dict[str, Any]:
    """Return the values of a document; none if it cannot be read."""
    try:
        values = json.loads(document or b"{}")
    except (ValueError, RecursionError):
        values = None
    if isinstance(values, dict):
        return values
    log.warning("the state of the guard before cannot be read")
    return {}


class FlowOrder:
    """Who comes first on a stream, for the next guard: the fresh flows and the owner of each stage.

    Without it the first publisher that comes back would have the output, whatever its priority. A
    fresh flow counts as if it spoke when the first publisher is back: lower ones wait until it is
    there too, or its time is over.
    """

    def __init__(self, topic: str, handover: HandoverState) -> None:
        self._key = f"order {topic}"
        self._handover = handover
        self._order: Any = handover.inherited(self._key) or []
        self._is_resumed = False

    def resume(self, policies: Sequence[Policy], now: int) -> None:
        """Let the policies go on where the guard before has ended; they have seen nothing yet."""
        if self._is_resumed:
            return
        self._is_resumed = True
        for policy, (flows, owner) in zip(policies, self._order, strict=False):
            lease = LeaseState(owner, now, now) if owner in flows else None
            times = dict.fromkeys(flows, now)
            policy.restore_state(
                PolicyState(last_message_times=times, has_lease=True, lease=lease), now
            )

    def store(self, policies: Sequence[Policy], now: int) -> None:
        """Store the order, if it has changed; not before the one that was inherited is in force."""
        order = [[sorted(each.last_message_times(now)), each.owner] for each in policies]
        if self._is_resumed and order != self._order:
            self._order = order
            self._handover.store(self._key, order)


_PERIOD_S = 1.0
_PRIVATE = 0o600


class HeartbeatFile:
    """A file whose modification time is the guard's last heartbeat.

    `previous_time` is the last heartbeat of the guard before, ns of the wall clock. It is 0 if
    unknown, as after a reboot, which ends the publishers too.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._worker = BackgroundWorker(self._touch, "heartbeat")
        self.previous_time = _modification_time(path)

    def beat(self, loop: EventLoop) -> None:
        """Have the file touched now, and each second from now on in which the loop comes round."""
        loop.call_later(_PERIOD_S, partial(self.beat, loop))
        self._worker.request()

    def _touch(self) -> None:
        try:
            self._path.touch(mode=_PRIVATE)
        except OSError as error:
            log.debug("the next guard will not know when this one ran: %s", error)


def heartbeat_path(control: Path, address: str) -> Path:
    """Return the file of the guard at a master or domain that listens at `control`."""
    return control.with_name(f"{control.stem}-{master_file_name(address)}.heartbeat")


def _modification_time(path: Path) -> int:
    """Return when a file was written (ns), now at the latest: the clock may have been set back."""
    try:
        return min(path.stat().st_mtime_ns, time.time_ns())
    except OSError:
        return 0

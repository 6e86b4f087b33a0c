"""The buttons that stop the robot: a node says on a topic (std_msgs/Bool) whether one is pressed.

What a button has stopped stays stopped until a person releases it. Until a button is heard, and
while its publisher is gone or silent for too long, nothing moves either; that ends by itself when
it is heard again. What nobody can read counts as pressed.
"""

import logging
from collections import Counter
from functools import partial

from rtron.errors import WireError
from rtron.guard.authority.latched_stops import LatchedStops
from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.core.printable import printable
from rtron.guard.transport.common.protocol import InputOptions, MessageHandler, Peer, Transport
from rtron.messages.common.encoding import PREFIX, Encoding
from rtron.vocabulary import GUARD_NODE, StopButton

log = logging.getLogger(__name__)

_BOOL = "std_msgs/Bool"


class StopButtons:
    """Listens to the buttons of a plan."""

    def __init__(
        self, buttons: tuple[StopButton, ...], stops: LatchedStops, transport: Transport
    ) -> None:
        self._buttons = buttons
        self._stops = stops
        self._transport = transport
        self._publishers: Counter[str] = Counter()
        self._log_throttle = LogThrottle()
        self._unheard: set[str] = set()
        self._last_times: dict[str, int] = {}
        self._watched: set[str] = set()
        for button in buttons:
            self._hold(button)

    def open(self) -> None:
        """Join the graph."""
        for button in self._buttons:
            connect, lose = partial(self._connect, button), partial(self._lose, button)
            options = InputOptions(publishers=(button.publisher,), on_lost=lose)
            self._transport.subscribe(GUARD_NODE, button.topic, _BOOL, connect, options)

    def close(self) -> None:
        """Do nothing: the transport leaves the graph."""

    def _connect(self, button: StopButton, peer: Peer) -> MessageHandler | None:
        if not (peer.verified and peer.node == button.publisher):
            if self._log_throttle.allows(peer.node, self._transport.now()):
                text = "stop button %s: %s is ignored: it is not %s, or only says so"
                log.warning(text, button.name, printable(peer.node), button.publisher)
            return None
        self._publishers[button.name] += 1
        return partial(self._on_message, button)

    def _on_message(self, button: StopButton, message: bytes) -> None:
        try:
            is_pressed = _read_bool(self._transport.encoding, message)
        except WireError as error:
            self._press(button, f"it says what nobody can read: {error}")
        else:
            if is_pressed:
                self._press(button, "pressed")
            else:
                self._stops.end_cause(button.name)
        self._record_message(button)

    def _record_message(self, button: StopButton) -> None:
        self._last_times[button.name] = self._transport.now()
        if button.name in self._unheard:
            self._unheard.discard(button.name)
            self._stops.let_go(_brake_of(button))
            self._watch(button)

    def _watch(self, button: StopButton) -> None:
        """Look again when the button would be silent for too long."""
        if button.silent_after is not None and button.name not in self._watched:
            self._watched.add(button.name)
            due = self._last_times[button.name] + button.silent_after
            self._transport.call_at(due, partial(self._on_deadline, button, button.silent_after))

    def _on_deadline(self, button: StopButton, silent_after: int) -> None:
        self._watched.discard(button.name)
        if button.name in self._unheard:
            return
        if self._transport.now() - self._last_times[button.name] < silent_after:
            self._watch(button)
            return
        log.error("stop button %s: %s is silent", button.name, button.publisher)
        self._hold(button)

    def _lose(self, button: StopButton, _peer: Peer) -> None:
        """Look a moment later whether any publisher is left: one may just be renewed."""
        self._publishers[button.name] -= 1
        self._transport.call_at(self._transport.now(), partial(self._hold_if_lost, button))

    def _hold_if_lost(self, button: StopButton) -> None:
        if not self._publishers[button.name]:
            log.error("stop button %s: %s is gone", button.name, button.publisher)
            self._hold(button)

    def _hold(self, button: StopButton) -> None:
        self._unheard.add(button.name)
        why = f"nothing is heard of the stop button {button.name}"
        self._stops.hold(_brake_of(button), why)

    def _press(self, button: StopButton, why: str) -> None:
        self._stops.stop(button.name, button.publisher, why, is_caused=True)


def _brake_of(button: StopButton) -> str:
    return f"stop button {button.name}"


def _read_bool(encoding: Encoding, message: bytes) -> bool:
    """Return the value of a std_msgs/Bool; WireError if it is none."""
    encoding.check_prefix(message)
    encoding.check_end(PREFIX + 1, message)
    return message[PREFIX] != 0

"""The bits of the eflows: which events are triggered, as far as anybody knows (paper section 5.3).

A bit is 1, 0 or unknown. It comes from the newest message, from a message within a time, or from
silence; nothing else is remembered. Why a bit is unknown is told apart: the source is silent or
gone (`on_silence`), or its message could not be judged (`on_error`); the plan says what either
counts as.
"""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from rtron.vocabulary import EventFlow, WhenUnknown

Truth = bool | None
"""1, 0, or None: nobody knows."""


class EventState(NamedTuple):
    """All that an eflow's bit depends on, beside the plan; times in ns.

    `publishers` are connected; the `newest` message was `judged`, and the last one for which `when`
    held came at `triggered`; there were `true_count` of these.
    """

    publishers: int = 0
    newest: int | None = None
    judged: Truth = None
    triggered: int | None = None
    true_count: int = 0


_COUNTS: Mapping[WhenUnknown, Truth] = {
    WhenUnknown.BLOCK: None,
    WhenUnknown.SET: True,
    WhenUnknown.CLEAR: False,
}


class EventBit:
    """One eflow, what was heard of it and when; its newest message counts for `max_age`.

    Two publishers at once, where the plan names them by a pattern, may contradict each other: then
    nobody knows the bit.
    """

    def __init__(self, flow: EventFlow) -> None:
        self.flow = flow
        self._publishers = 0
        self._newest: int | None = None
        self._judged: Truth = None
        self._triggered: int | None = None
        self._true_count = 0
        self._last_known: Truth = None
        self._is_observed = True

    def add_publisher(self) -> None:
        """Note that the publisher is connected."""
        self._publishers += 1

    def remove_publisher(self) -> None:
        """Note that a connection to the publisher ended."""
        self._publishers -= 1
        if not self._publishers:
            self._newest = None

    def observe(self, judged: Truth, now: int) -> None:
        """Take a message: whether `when` holds for it, None if that cannot be told."""
        self._newest, self._judged = now, judged
        if judged:
            self._triggered = now
            self._true_count += 1

    @property
    def state(self) -> EventState:
        """What was heard until now, for `restore`."""
        return EventState(
            self._publishers, self._newest, self._judged, self._triggered, self._true_count
        )

    def restore(self, state: EventState) -> bool:
        """Take what another process has heard; tell whether `when` held for a message since."""
        before, self._is_observed = self._true_count, True
        self._publishers, self._newest, self._judged, self._triggered, self._true_count = state
        return self._true_count > before

    def forget(self) -> None:
        """Let nobody know the bit, whatever the plan says of silence, until `restore`.

        Who listens to the source is away: whether it is silent cannot be told.
        """
        self._is_observed = False

    def value(self, now: int) -> Truth:
        """Return the bit at `now`, with what the plan says that an unknown one counts as."""
        if not self._is_observed:
            return None
        value = self._read(now) if self._publishers <= 1 else self.flow.on_error
        if isinstance(value, WhenUnknown):
            return self._last_known if value is WhenUnknown.KEEP else _COUNTS[value]
        self._last_known = value
        return value

    def next_change(self) -> int | None:
        """Return when the bit changes if nothing more is heard; None if it does not."""
        return None if self._newest is None else self._newest + self.flow.max_age

    def _read(self, now: int) -> bool | WhenUnknown:
        if self._newest is None or now - self._newest >= self.flow.max_age:
            return self.flow.on_silence
        return self.flow.on_error if self._judged is None else self._judged

    def _within(self, duration: int, now: int) -> bool:
        return self._triggered is not None and now - self._triggered < duration


class PresenceBit(EventBit):
    """Triggered for a time after each event, as long as somebody is there to tell."""

    def __init__(self, flow: EventFlow, present: int) -> None:
        super().__init__(flow)
        self._present = present

    def next_change(self) -> int | None:
        """Return when the event counts as over."""
        return None if self._triggered is None else self._triggered + self._present

    def _read(self, now: int) -> bool | WhenUnknown:
        if not self._publishers:
            return self.flow.on_silence
        if self._newest is not None and self._judged is None:
            return self.flow.on_error
        return self._within(self._present, now)


class SilenceBit(EventBit):
    """Triggered by silence, also before the first message: a heartbeat that nobody hears."""

    def __init__(self, flow: EventFlow, silent: int) -> None:
        super().__init__(flow)
        self._silent = silent

    def next_change(self) -> int | None:
        """Return when the silence counts."""
        return None if self._triggered is None else self._triggered + self._silent

    def _read(self, now: int) -> bool | WhenUnknown:
        return not self._within(self._silent, now)


class EventBits:
    """All eflows of an app."""

    def __init__(self, flows: Iterable[EventFlow] = ()) -> None:
        self.by_name = {flow.name: _bit(flow) for flow in flows}

    def known_values(self, now: int) -> dict[str, bool]:
        """Return the bits that are 1 or 0 at `now`."""
        values = ((name, bit.value(now)) for name, bit in self.by_name.items())
        return {name: value for name, value in values if value is not None}

    def deadline(self, now: int) -> int | None:
        """Return when a bit next changes if nothing more is heard."""
        times = (bit.next_change() for bit in self.by_name.values())
        return min((time for time in times if time is not None and time > now), default=None)


def _bit(flow: EventFlow) -> EventBit:
    if flow.silent is not None:
        return SilenceBit(flow, flow.silent)
    return EventBit(flow) if flow.present is None else PresenceBit(flow, flow.present)

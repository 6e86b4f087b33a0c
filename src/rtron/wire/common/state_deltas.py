"""A guard's state as what differs from the one before: most of a state stays as it was."""

from dataclasses import fields, replace

from rtron.errors import WireError
from rtron.vocabulary import GuardState
from rtron.wire.common.link_protocol import StateDelta

_FIELDS = tuple(each.name for each in fields(GuardState) if each.name not in ("at", "streams"))
_EMPTY = GuardState(at=0, revision=0)


def state_delta(before: GuardState, state: GuardState) -> StateDelta | None:
    """Return what differs; None if the streams are not those of before, so all is to be told."""
    if [each.topic for each in before.streams] != [each.topic for each in state.streams]:
        return None
    unchanged = tuple(name for name in _FIELDS if _is_unchanged(name, before, state))
    known = zip(before.streams, state.streams, strict=True)
    streams = tuple(stream for previous, stream in known if previous != stream)
    left_out = {name: getattr(_EMPTY, name) for name in unchanged}
    return StateDelta(state=replace(state, streams=streams, **left_out), unchanged=unchanged)


def _is_unchanged(name: str, before: GuardState, state: GuardState) -> bool:
    """Tell whether to leave a field out; None is as short, and a service may not know the field."""
    value = getattr(state, name)
    return value is not None and getattr(before, name) == value


def apply_state_delta(before: GuardState, change: StateDelta) -> GuardState:
    """Return the state that a change makes of the one before; WireError if it does not fit."""
    changed = {stream.topic: stream for stream in change.state.streams}
    if not set(change.unchanged) <= set(_FIELDS):
        raise WireError("a change of the state leaves out what a state has not")
    if not changed.keys() <= {stream.topic for stream in before.streams}:
        raise WireError("a change of the state has a stream that is not known")
    streams = tuple(changed.get(stream.topic, stream) for stream in before.streams)
    unchanged = {name: getattr(before, name) for name in change.unchanged}
    return replace(change.state, streams=streams, **unchanged)

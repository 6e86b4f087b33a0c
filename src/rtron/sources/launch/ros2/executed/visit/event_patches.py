"""Events that a visit brings about, and those that it has to do without."""

from collections.abc import Callable, Iterable
from typing import Any, TypeAlias

import launch.actions
import launch.events

from .locations import local, remembered
from .process_stub import ENDS
from .visit_record import Found

Thing: TypeAlias = Any
Method: TypeAlias = Callable[..., Any]

_EVENT = "rtron_event"
_TRANSITION = "OnStateTransition"
_NAMES = {
    "ExecutionComplete": "OnExecutionComplete",
    "IncludeLaunchDescription": "",
    "ProcessExited": "OnProcessExit",
    "ProcessStarted": "OnProcessStart",
    "Shutdown": "OnShutdown",
    "TimerEvent": "timer",
}


def event_of(context: Thing) -> str:
    """Return what the action waited for that is being executed; empty for nothing."""
    told = local(context, _EVENT)
    event = local(context, "event")
    name = type(event).__name__
    return str(told) if told is not None else _NAMES.get(name, name) if event is not None else ""


class Waiting:
    """Lets timers and handlers run, and notes the handlers whose event does not come."""

    def __init__(self, found: Found) -> None:
        self._found = found

    def emitting(self, original: Method, action: Thing, context: Thing) -> object:
        """Emit an event, but no shutdown: what would start later is to be seen."""
        if isinstance(action.event, launch.events.Shutdown):
            return None
        return original(action, context)

    def firing(self, original: Method, timer: Thing, context: Thing) -> object:
        """Return a timer's actions; they wait for it, or for what it stands for."""
        result = original(timer, context)
        context.extend_locals({_EVENT: getattr(timer, _EVENT, "timer")})
        return result

    def registering(self, original: Method, action: Thing, context: Thing) -> object:
        """Register a handler; a lifecycle node's state comes without the node."""
        handler = action.event_handler
        entities = getattr(handler, "entities", None)
        if type(handler).__name__ == _TRANSITION and not callable(entities):
            return [self._reached(entities)]
        self._watch(handler, action, context)
        return original(action, context)

    def _reached(self, entities: Thing) -> Thing:
        listed = list(entities) if isinstance(entities, Iterable) else [entities]
        timer = launch.actions.TimerAction(period=ENDS / 2, actions=listed)
        setattr(timer, _EVENT, _TRANSITION)
        return timer

    def _watch(self, handler: Thing, action: Thing, context: Thing) -> None:
        """Note a handler until its event comes."""
        why = f"{type(handler).__name__}: its event does not come while nothing runs"
        self._found.note(why, remembered(action, context))
        note, handle = self._found.notes[-1], handler.handle

        def handled(event: object, context: object) -> object:
            if note in self._found.notes:
                self._found.notes.remove(note)
            return handle(event, context)

        handler.handle = handled

"""Events that a visit brings about, and those that it has to do without."""

from collections.abc import Callable, Iterable
from typing import Any, TypeAlias

import launch.actions
import launch.events

from .locations import context_local, creation_location
from .process_stub import EXIT_DELAY_S
from .visit_record import VisitRecord

Thing: TypeAlias = Any
Method: TypeAlias = Callable[..., Any]

_EVENT_LOCAL = "rtron_event"
_TRANSITION = "OnStateTransition"
_NAMES = {
    "ExecutionComplete": "OnExecutionComplete",
    "IncludeLaunchDescription": "",
    "ProcessExited": "OnProcessExit",
    "ProcessStarted": "OnProcessStart",
    "Shutdown": "OnShutdown",
    "TimerEvent": "timer",
}


def current_event(context: Thing) -> str:
    """Return what the action waited for that is being executed; empty for nothing."""
    event_name = context_local(context, _EVENT_LOCAL)
    event = context_local(context, "event")
    name = type(event).__name__
    return (
        str(event_name)
        if event_name is not None
        else _NAMES.get(name, name)
        if event is not None
        else ""
    )


class EventPatches:
    """Lets timers and handlers run, and notes the handlers whose event does not come."""

    def __init__(self, record: VisitRecord) -> None:
        self._record = record

    def execute_emit(self, original: Method, action: Thing, context: Thing) -> object:
        """Emit an event, but no shutdown: what would start later is to be seen."""
        if isinstance(action.event, launch.events.Shutdown):
            return None
        return original(action, context)

    def handle_timer(self, original: Method, timer: Thing, context: Thing) -> object:
        """Return a timer's actions; they wait for it, or for what it stands for."""
        result = original(timer, context)
        context.extend_locals({_EVENT_LOCAL: getattr(timer, _EVENT_LOCAL, "timer")})
        return result

    def execute_register(self, original: Method, action: Thing, context: Thing) -> object:
        """Register a handler; a lifecycle node's state comes without the node."""
        handler = action.event_handler
        entities = getattr(handler, "entities", None)
        if type(handler).__name__ == _TRANSITION and not callable(entities):
            return [self._state_timer(entities)]
        self._note_until_handled(handler, action, context)
        return original(action, context)

    def _state_timer(self, entities: Thing) -> Thing:
        actions = list(entities) if isinstance(entities, Iterable) else [entities]
        timer = launch.actions.TimerAction(period=EXIT_DELAY_S / 2, actions=actions)
        setattr(timer, _EVENT_LOCAL, _TRANSITION)
        return timer

    def _note_until_handled(self, handler: Thing, action: Thing, context: Thing) -> None:
        """Note a handler until its event comes."""
        why = f"{type(handler).__name__}: its event does not come while nothing runs"
        self._record.note(why, creation_location(action, context))
        note, handle = self._record.notes[-1], handler.handle

        def handled(event: object, context: object) -> object:
            if note in self._record.notes:
                self._record.notes.remove(note)
            return handle(event, context)

        handler.handle = handled

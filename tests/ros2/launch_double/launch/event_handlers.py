from launch.event_handler import BaseEventHandler
from launch.events import ExecutionComplete, ProcessExited, ProcessStarted


class _OnAction(BaseEventHandler):
    def __init__(self, event_class, target_action, then, **kwargs):
        def matcher(event):
            if not isinstance(event, event_class):
                return False
            if callable(target_action):
                return target_action(event.action)
            return target_action is None or event.action is target_action

        super().__init__(matcher=matcher, **kwargs)
        self.then = then

    def handle(self, event, context):
        super().handle(event, context)
        return self.then(event, context) if callable(self.then) else self.then


class OnProcessStart(_OnAction):
    def __init__(self, *, target_action=None, on_start, **kwargs):
        super().__init__(ProcessStarted, target_action, on_start, **kwargs)


class OnProcessExit(_OnAction):
    def __init__(self, *, target_action=None, on_exit, **kwargs):
        super().__init__(ProcessExited, target_action, on_exit, **kwargs)


class OnExecutionComplete(_OnAction):
    def __init__(self, *, target_action=None, on_completion, **kwargs):
        super().__init__(ExecutionComplete, target_action, on_completion, **kwargs)

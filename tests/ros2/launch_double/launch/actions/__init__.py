from launch.actions.execute_local import ExecuteLocal, ExecuteProcess
from launch.core import Action, normalize, perform
from launch.event_handler import EventHandler
from launch.events import Shutdown as ShutdownEvent
from launch.events import TimerEvent
from launch.launch_description_sources import LaunchDescriptionSource

__all__ = [
    "DeclareLaunchArgument",
    "ExecuteLocal",
    "ExecuteProcess",
    "GroupAction",
    "IncludeLaunchDescription",
    "OpaqueFunction",
    "RegisterEventHandler",
    "SetEnvironmentVariable",
    "SetLaunchConfiguration",
    "Shutdown",
    "TimerAction",
    "UnregisterEventHandler",
]


class DeclareLaunchArgument(Action):
    def __init__(self, name, *, default_value=None, **kwargs):
        super().__init__(**kwargs)
        self.name = name
        self.default_value = None if default_value is None else normalize(default_value)
        self.maybe = False

    def execute(self, context):
        if self.name not in context.launch_configurations:
            if self.default_value is None:
                raise RuntimeError(f'Required launch argument "{self.name}" was not provided.')
            context.launch_configurations[self.name] = perform(context, self.default_value)


class SetLaunchConfiguration(Action):
    def __init__(self, name, value, **kwargs):
        super().__init__(**kwargs)
        self.name, self.value = normalize(name), normalize(value)

    def execute(self, context):
        value = perform(context, self.value)
        context.launch_configurations[perform(context, self.name)] = value


class SetEnvironmentVariable(Action):
    def __init__(self, name, value, **kwargs):
        super().__init__(**kwargs)
        self.name, self.value = normalize(name), normalize(value)

    def execute(self, context):
        context.environment[perform(context, self.name)] = perform(context, self.value)


class IncludeLaunchDescription(Action):
    def __init__(self, launch_description_source, *, launch_arguments=None, **kwargs):
        super().__init__(**kwargs)
        assert isinstance(launch_description_source, LaunchDescriptionSource)
        self.launch_description_source = launch_description_source
        self.launch_arguments = tuple(launch_arguments or ())

    def get_sub_entities(self):
        found = self.launch_description_source.try_get_launch_description_without_context()
        return [] if found is None else [found]

    def execute(self, context):
        description = self.launch_description_source.get_launch_description(context)
        context.extend_locals({"current_launch_file_path": self.launch_description_source.path})
        given = [name for name, _ in self.launch_arguments]
        for argument in description.get_launch_arguments():
            if argument.default_value is None and not argument.maybe and argument.name not in given:
                raise RuntimeError(f"missing required argument '{argument.name}'")
        return [*(SetLaunchConfiguration(*pair) for pair in self.launch_arguments), description]


class OpaqueFunction(Action):
    def __init__(self, *, function, args=(), kwargs=None, **left):
        super().__init__(**left)
        self.function, self.args, self.kwargs = function, args, kwargs or {}

    def execute(self, context):
        return self.function(context, *self.args, **self.kwargs)


class _Push(Action):
    def execute(self, context):
        context.stack.append(context.launch_configurations.copy())


class _Pop(Action):
    def execute(self, context):
        context.launch_configurations = context.stack.pop()


class _Reset(Action):
    def execute(self, context):
        context.launch_configurations.clear()


class GroupAction(Action):
    def __init__(self, actions, *, scoped=True, forwarding=True, **left):
        super().__init__(**left)
        inner = [] if forwarding else [_Reset()]
        self.inner = [_Push(), *inner, *actions, _Pop()] if scoped else list(actions)

    def get_sub_entities(self):
        return self.inner

    def execute(self, context):
        return self.inner


class RegisterEventHandler(Action):
    def __init__(self, event_handler, **kwargs):
        super().__init__(**kwargs)
        self.__event_handler = event_handler

    @property
    def event_handler(self):
        return self.__event_handler

    def execute(self, context):
        context.register_event_handler(self.__event_handler)


class UnregisterEventHandler(Action):
    def __init__(self, event_handler, **kwargs):
        super().__init__(**kwargs)
        self.event_handler = event_handler

    def execute(self, context):
        context.unregister_event_handler(self.event_handler)


class Shutdown(Action):
    def __init__(self, *, reason="reason not given", **kwargs):
        super().__init__(**kwargs)
        self.reason = reason

    def execute(self, context):
        context.emit_event_sync(ShutdownEvent(reason=self.reason))


class TimerAction(Action):
    def __init__(self, *, period, actions, **kwargs):
        super().__init__(**kwargs)
        self.__actions = actions

    @property
    def actions(self):
        return self.__actions

    def handle(self, context):
        return self.__actions

    def execute(self, context):
        if not hasattr(context, "_fires"):
            context._fires = EventHandler(
                matcher=lambda event: isinstance(event, TimerEvent),
                entities=OpaqueFunction(
                    function=lambda context: context.event.timer_action.handle(context)
                ),
            )
            context.register_event_handler(context._fires)
        context.emit_event_sync(TimerEvent(timer_action=self))

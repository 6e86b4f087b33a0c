import collections
import os
import types


class LaunchDescriptionEntity:
    def describe(self):
        return repr(self)

    def describe_sub_entities(self):
        return []

    def describe_conditional_sub_entities(self):
        return []

    def visit(self, context):
        return None

    def get_asyncio_future(self):
        return None


class Substitution:
    def perform(self, context):
        raise NotImplementedError


class TextSubstitution(Substitution):
    def __init__(self, *, text):
        self.text = text

    def perform(self, context):
        return self.text


def normalize(some):
    if isinstance(some, str):
        return [TextSubstitution(text=some)]
    if isinstance(some, Substitution):
        return [some]
    return [one for item in some for one in normalize(item)]


def perform(context, substitutions):
    return "".join(context.perform_substitution(one) for one in substitutions)


class LaunchContext:
    def __init__(self):
        self.launch_configurations = {}
        self.stack = []
        self.handlers = collections.deque()
        self.events = collections.deque()
        self.is_shutdown = False
        self.environment = os.environ
        self._locals = [{}]

    @property
    def locals(self):
        return types.SimpleNamespace(**self._locals[-1])

    def extend_locals(self, values):
        self._locals[-1].update(values)

    def push_locals(self):
        self._locals.append(dict(self._locals[-1]))

    def pop_locals(self):
        self._locals.pop()

    def perform_substitution(self, substitution):
        return substitution.perform(self)

    def register_event_handler(self, handler, append=False):  # noqa: FBT002
        (self.handlers.append if append else self.handlers.appendleft)(handler)

    def unregister_event_handler(self, handler):
        self.handlers.remove(handler)

    def emit_event_sync(self, event):
        self.events.append(event)


class Action(LaunchDescriptionEntity):
    def __init__(self, *, condition=None):
        self.__condition = condition

    @property
    def condition(self):
        return self.__condition

    def get_sub_entities(self):
        return []

    def describe_sub_entities(self):
        return self.get_sub_entities() if self.condition is None else []

    def describe_conditional_sub_entities(self):
        return [("", self.get_sub_entities())] if self.condition is not None else []

    def visit(self, context):
        from launch.events import ExecutionComplete  # noqa: PLC0415 - it imports this

        if self.__condition is None or self.__condition.evaluate(context):
            try:
                return self.execute(context)
            finally:
                event = ExecutionComplete(action=self)
                if any(handler.matches(event) for handler in context.handlers):
                    context.emit_event_sync(event)
        return None

    def execute(self, context):
        return None


class LaunchDescription(LaunchDescriptionEntity):
    def __init__(self, initial_entities=None):
        self.entities = list(initial_entities or ())

    def add_action(self, action):
        self.entities.append(action)

    def visit(self, context):
        return self.entities

    def describe_sub_entities(self):
        return self.entities

    def get_launch_arguments(self):
        from launch.actions import DeclareLaunchArgument  # noqa: PLC0415 - it imports this

        found = {}

        def look(entities, *, maybe):
            for entity in entities:
                if isinstance(entity, DeclareLaunchArgument):
                    entity.maybe = maybe or entity.condition is not None
                    found.setdefault(entity.name, entity)
                look(entity.describe_sub_entities(), maybe=maybe)
                for _, inner in entity.describe_conditional_sub_entities():
                    look(inner, maybe=True)

        look(self.entities, maybe=False)
        return list(found.values())

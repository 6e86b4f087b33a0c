class BaseEventHandler:
    def __init__(self, *, matcher, handle_once=False):
        self.__matcher, self.__handle_once = matcher, handle_once

    @property
    def handle_once(self):
        return self.__handle_once

    def matches(self, event):
        return self.__matcher(event)

    def describe(self):
        return (type(self).__name__, [])

    def handle(self, event, context):
        context.extend_locals({"event": event})
        if self.handle_once:
            context.unregister_event_handler(self)


class EventHandler(BaseEventHandler):
    def __init__(self, *, matcher, entities=None, handle_once=False):
        super().__init__(matcher=matcher, handle_once=handle_once)
        self.entities = entities

    def handle(self, event, context):
        super().handle(event, context)
        return self.entities

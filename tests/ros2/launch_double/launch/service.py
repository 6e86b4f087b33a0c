from launch.core import LaunchDescriptionEntity
from launch.events import IncludeLaunchDescription, Shutdown


def visit_all(entity, context):
    assert isinstance(entity, LaunchDescriptionEntity), entity
    inner = entity.visit(context)
    entity.get_asyncio_future()
    for one in inner or ():
        visit_all(one, context)


def process(event, context):
    if isinstance(event, IncludeLaunchDescription):
        visit_all(event.launch_description, context)
    if isinstance(event, Shutdown):
        context.is_shutdown = context.is_shutdown or event.reason
    for handler in tuple(context.handlers):
        if handler.matches(event):
            context.event = event
            context.push_locals()
            given = handler.handle(event, context)
            given = given if isinstance(given, (list, tuple)) else [given]
            for entity in given:
                if entity is not None:
                    visit_all(entity, context)
            context.pop_locals()

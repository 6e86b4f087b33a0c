"""What `ros2 launch FILE NAME:=VALUE…` would start, as JSON."""

import json
import logging
import sys

from launch import LaunchContext, LaunchDescriptionEntity
from launch.actions import IncludeLaunchDescription, _Starting
from launch.events import IncludeLaunchDescription as IncludeEvent
from launch.events import Shutdown
from launch.launch_description_sources import AnyLaunchDescriptionSource


def visit_all(entity, context):
    assert isinstance(entity, LaunchDescriptionEntity), entity
    inner = entity.visit(context)
    entity.get_asyncio_future()
    for one in inner or ():
        visit_all(one, context)


def process(event, context):
    if isinstance(event, _Starting):
        event.start(context)
        return
    if isinstance(event, IncludeEvent):
        visit_all(event.launch_description, context)
    if isinstance(event, Shutdown):
        context.is_shutdown = context.is_shutdown or event.reason
    for handler in tuple(context.handlers):
        if handler.matches(event):
            context.event = event
            given = handler.handle(event, context)
            given = given if isinstance(given, (list, tuple)) else [given]
            for entity in given:
                if entity is not None:
                    visit_all(entity, context)


def run(path, arguments):
    context = LaunchContext()
    context.started, context.loaded, told = [], [], []
    handler = logging.Handler()
    handler.emit = lambda record: told.append(record.getMessage())
    logging.getLogger("rtron").addHandler(handler)
    error, declared = "", []
    description = AnyLaunchDescriptionSource(path)
    try:
        shown = description.get_launch_description(context).get_launch_arguments()
        declared = [argument.name for argument in shown]
        visit_all(IncludeLaunchDescription(description, launch_arguments=arguments), context)
        while context.events and not context.is_shutdown:
            process(context.events.popleft(), context)
    except Exception as raised:  # noqa: BLE001 - as launch does
        error = f"{type(raised).__name__}: {raised}"
    return {
        "arguments": declared,
        "started": context.started,
        "loaded": context.loaded,
        "told": told,
        "error": error,
        "shutdown": context.is_shutdown,
    }


if __name__ == "__main__":
    pairs = [tuple(word.split(":=", 1)) for word in sys.argv[2:]]
    print(json.dumps(run(sys.argv[1], pairs)))

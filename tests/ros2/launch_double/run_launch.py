"""What `ros2 launch FILE NAME:=VALUE…` would start, as JSON."""

import json
import logging
import sys

from launch import LaunchContext
from launch.actions import IncludeLaunchDescription
from launch.actions.execute_local import _Starting
from launch.launch_description_sources import AnyLaunchDescriptionSource
from launch.service import process, visit_all


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
            event = context.events.popleft()
            event.start(context) if isinstance(event, _Starting) else process(event, context)
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

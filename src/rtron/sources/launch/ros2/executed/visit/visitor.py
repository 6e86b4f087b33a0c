"""Visits a launch file as `ros2 launch` does, with all replaced that would start something."""

import asyncio
import json
import logging
import os
import sys
from pathlib import Path

from .clock import ImpatientLoop
from .locations import of_error
from .visit_record import Found, placed


class _Errors(logging.Handler):
    """Takes the first exception that launch logs: it goes on to its end with each of them."""

    def __init__(self, found: Found) -> None:
        super().__init__()
        self._found = found

    def emit(self, record: logging.LogRecord) -> None:
        """Keep an exception."""
        raised = (record.exc_info or sys.exc_info())[1]
        if raised is not None and self._found.error is None:
            told(self._found, raised)


def main(request: str) -> None:
    """Visit the launch file of a request, and write what was found where the request says."""
    wanted = json.loads(Path(request).read_text(encoding="utf-8"))
    found = Found()
    try:
        _visit(found, wanted["file"], wanted["arguments"])
    except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever it is, it is told
        told(found, error)
    _write(found, Path(wanted["result"]))
    os._exit(0)  # what threads of the launch file still do counts no more


def told(found: Found, error: BaseException) -> None:
    """Keep the exception that ended a launch: the first cause of it."""
    cause, seen = error, {id(error)}
    while cause.__cause__ is not None and id(cause.__cause__) not in seen:
        cause = cause.__cause__
        seen.add(id(cause))
    text = f"{type(cause).__name__}: {cause}"
    found.error = {"text": text[:2000], "place": placed(of_error(cause))}


def _visit(found: Found, file: str, arguments: list[list[str]]) -> None:
    try:
        import launch.actions  # noqa: PLC0415 - whether it is there is asked here
        import launch.launch_description_sources  # noqa: PLC0415 - likewise
        import launch_ros.actions  # noqa: F401, PLC0415 - likewise
    except ImportError as error:
        found.missing = str(error) or "launch"
        return
    from .patches import replace_all  # noqa: PLC0415 - it imports launch

    replace_all(found, file)
    asyncio.set_event_loop(ImpatientLoop())
    for name in ("launch", "asyncio"):
        logging.getLogger(name).addHandler(_Errors(found))
    source = launch.launch_description_sources.AnyLaunchDescriptionSource(file)
    given = [(name, value) for name, value in arguments]
    included = launch.actions.IncludeLaunchDescription(source, launch_arguments=given)
    service = launch.LaunchService(noninteractive=True)
    service.include_launch_description(launch.LaunchDescription([included]))
    if service.run() and found.error is None:
        found.error = {"text": "launch ends with a fault", "place": placed((file, 0))}


def _write(found: Found, path: Path) -> None:
    """Write the file whole or not at all."""
    part = path.with_suffix(".part")
    part.write_text(json.dumps(found.document()), encoding="utf-8")
    part.replace(path)

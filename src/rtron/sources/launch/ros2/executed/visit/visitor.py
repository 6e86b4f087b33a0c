"""Visits a launch file as `ros2 launch` does, with all replaced that would start something."""

import asyncio
import json
import logging
import os
import sys
from pathlib import Path

from .clock import TimeSkippingLoop
from .locations import error_location
from .visit_record import VisitRecord, location_fields


class _ErrorHandler(logging.Handler):
    """Takes the first exception that launch logs: it goes on to its end with each of them."""

    def __init__(self, record: VisitRecord) -> None:
        super().__init__()
        self._record = record

    def emit(self, record: logging.LogRecord) -> None:
        """Keep an exception."""
        error = (record.exc_info or sys.exc_info())[1]
        if error is not None and self._record.error is None:
            record_error(self._record, error)


def main(request: str) -> None:
    """Visit the launch file of a request, and write what was found where the request says."""
    fields = json.loads(Path(request).read_text(encoding="utf-8"))
    record = VisitRecord()
    try:
        _visit_file(record, fields["file"], fields["arguments"])
    except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever it is, it is told
        record_error(record, error)
    _write(record, Path(fields["result"]))
    os._exit(0)  # what threads of the launch file still do counts no more


def record_error(record: VisitRecord, error: BaseException) -> None:
    """Keep the exception that ended a launch: the first cause of it."""
    cause, visited = error, {id(error)}
    while cause.__cause__ is not None and id(cause.__cause__) not in visited:
        cause = cause.__cause__
        visited.add(id(cause))
    text = f"{type(cause).__name__}: {cause}"
    record.error = {"text": text[:2000], "place": location_fields(error_location(cause))}


def _visit_file(record: VisitRecord, file: str, arguments: list[list[str]]) -> None:
    try:
        import launch.actions  # noqa: PLC0415 - whether it is there is asked here
        import launch.launch_description_sources  # noqa: PLC0415 - likewise
        import launch_ros.actions  # noqa: F401, PLC0415 - likewise
    except ImportError as error:
        record.missing = str(error) or "launch"
        return
    from .patches import patch_launch  # noqa: PLC0415 - it imports launch

    patch_launch(record, file)
    asyncio.set_event_loop(TimeSkippingLoop())
    for name in ("launch", "asyncio"):
        logging.getLogger(name).addHandler(_ErrorHandler(record))
    source = launch.launch_description_sources.AnyLaunchDescriptionSource(file)
    launch_arguments = [(name, value) for name, value in arguments]
    included = launch.actions.IncludeLaunchDescription(source, launch_arguments=launch_arguments)
    service = launch.LaunchService(noninteractive=True)
    service.include_launch_description(launch.LaunchDescription([included]))
    if service.run() and record.error is None:
        record.error = {"text": "launch ends with a fault", "place": location_fields((file, 0))}


def _write(record: VisitRecord, path: Path) -> None:
    """Write the file whole or not at all."""
    part = path.with_suffix(".part")
    part.write_text(json.dumps(record.document()), encoding="utf-8")
    part.replace(path)

"""Where in a launch file something stands."""

import sys
import sysconfig
from pathlib import Path
from types import FrameType
from typing import Any, TypeAlias

Location: TypeAlias = tuple[str, int]
Thing: TypeAlias = Any

LOCATION_ATTRIBUTE = "_rtron_place"
_UNKNOWN_LOCATION = ("", 0)
_LAUNCH_PACKAGES = frozenset(
    {
        "asyncio",
        "concurrent",
        "importlib",
        "launch",
        "launch_ros",
        "launch_testing",
        "launch_xml",
        "launch_yaml",
        "osrf_pycommon",
        "rtron_visit",
        "runpy",
        "threading",
    }
)


def caller_location() -> Location:
    """Return the place of the innermost call that is not the launch library's own."""
    frame: FrameType | None = sys._getframe(1)  # noqa: SLF001 - what it is there for
    while frame is not None:
        if _is_user_code(frame):
            return frame.f_code.co_filename, frame.f_lineno
        frame = frame.f_back
    return _UNKNOWN_LOCATION


def creation_location(thing: Thing, context: Thing) -> Location:
    """Return where something was made; what XML or YAML made stands in the file being read."""
    location: Location = getattr(thing, LOCATION_ATTRIBUTE, _UNKNOWN_LOCATION)
    return (
        location
        if location[0]
        else (str(context_local(context, "current_launch_file_path") or ""), 0)
    )


def context_local(context: Thing, name: str) -> Thing:
    """Return a local of a launch context, None where there is none."""
    try:
        return getattr(context.locals, name)
    except AttributeError:
        return None


def error_location(error: BaseException) -> Location:
    """Return where an exception came from: the innermost line that is no library's."""
    if isinstance(error, SyntaxError) and error.filename:
        return error.filename, error.lineno or 0
    location, trace = _UNKNOWN_LOCATION, error.__traceback__
    libraries = tuple(f"{folder}/" for folder in _libraries())
    while trace is not None:
        frame = trace.tb_frame
        if _is_user_code(frame) and not frame.f_code.co_filename.startswith(libraries):
            location = frame.f_code.co_filename, trace.tb_lineno
        trace = trace.tb_next
    return location


def _libraries() -> list[str]:
    """Return where Python's library and the launch library lie."""
    launch = getattr(sys.modules.get("launch"), "__file__", None)
    launch_folder = [str(Path(launch).parents[1])] if launch else []
    return [*sysconfig.get_paths().values(), *launch_folder]


def _is_user_code(frame: FrameType) -> bool:
    name = str(frame.f_globals.get("__name__", "")).partition(".")[0]
    file = frame.f_code.co_filename
    return name not in _LAUNCH_PACKAGES and name != "__main__" and not file.startswith("<")

"""Where in a launch file something stands."""

import sys
import sysconfig
from pathlib import Path
from types import FrameType
from typing import Any, TypeAlias

Place: TypeAlias = tuple[str, int]
Thing: TypeAlias = Any

KEY = "_rtron_place"
_NO_FILE = ("", 0)
_OF_LAUNCH = frozenset(
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


def called_from() -> Place:
    """Return the place of the innermost call that is not the launch library's own."""
    frame: FrameType | None = sys._getframe(1)  # noqa: SLF001 - what it is there for
    while frame is not None:
        if _is_users(frame):
            return frame.f_code.co_filename, frame.f_lineno
        frame = frame.f_back
    return _NO_FILE


def remembered(thing: Thing, context: Thing) -> Place:
    """Return where something was made; what XML or YAML made stands in the file being read."""
    place: Place = getattr(thing, KEY, _NO_FILE)
    return place if place[0] else (str(local(context, "current_launch_file_path") or ""), 0)


def local(context: Thing, name: str) -> Thing:
    """Return a local of a launch context, None where there is none."""
    try:
        return getattr(context.locals, name)
    except AttributeError:
        return None


def of_error(error: BaseException) -> Place:
    """Return where an exception came from: the innermost line that is no library's."""
    if isinstance(error, SyntaxError) and error.filename:
        return error.filename, error.lineno or 0
    found, trace = _NO_FILE, error.__traceback__
    libraries = tuple(f"{folder}/" for folder in _libraries())
    while trace is not None:
        frame = trace.tb_frame
        if _is_users(frame) and not frame.f_code.co_filename.startswith(libraries):
            found = frame.f_code.co_filename, trace.tb_lineno
        trace = trace.tb_next
    return found


def _libraries() -> list[str]:
    """Return where Python's library and the launch library lie."""
    launch = getattr(sys.modules.get("launch"), "__file__", None)
    own = [str(Path(launch).parents[1])] if launch else []
    return [*sysconfig.get_paths().values(), *own]


def _is_users(frame: FrameType) -> bool:
    name = str(frame.f_globals.get("__name__", "")).partition(".")[0]
    file = frame.f_code.co_filename
    return name not in _OF_LAUNCH and name != "__main__" and not file.startswith("<")

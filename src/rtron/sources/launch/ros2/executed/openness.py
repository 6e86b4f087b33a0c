"""Whether reading a launch file leaves something open that executing it may tell."""

from collections.abc import Iterator

from rtron.sources.launch.ros2.result import AppLaunch, Start
from rtron.vocabulary import UnknownValue

_HOLE = "{"
"""How what is not known of a text begins where it is shown; a text may be written so, too."""


def leaves_open(launch: AppLaunch) -> bool:
    """Tell whether something of a launch is not known."""
    return bool(launch.unresolved) or any(map(_is_open, launch.starts))


def _is_open(start: Start) -> bool:
    unsure = start.doubtful or not start.complete
    return unsure or any(_HOLE in text for text in _texts(start)) or _has_unknown(start)


def _texts(start: Start) -> Iterator[str]:
    yield from (start.package, start.program, start.full_name, start.container, *start.arguments)
    for pair in (*start.remaps, *start.environ):
        yield from pair


def _has_unknown(start: Start) -> bool:
    return any(
        isinstance(one.value, UnknownValue)
        for source in start.sources
        for _, values in source.entries
        for one in values.values()
    )

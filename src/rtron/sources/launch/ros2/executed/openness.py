"""Whether reading a launch file leaves something open that executing it may tell."""

from collections.abc import Iterator

from rtron.sources.launch.ros2.result import AppLaunch, LaunchStart
from rtron.vocabulary import UnknownValue

_PLACEHOLDER_START = "{"
"""How what is not known of a text begins where it is shown; a text may be written so, too."""


def is_incomplete(launch: AppLaunch) -> bool:
    """Tell whether something of a launch is not known."""
    return bool(launch.unresolved) or any(map(_is_incomplete_start, launch.starts))


def _is_incomplete_start(start: LaunchStart) -> bool:
    unsure = start.is_uncertain or not start.parameters_complete
    return (
        unsure
        or any(_PLACEHOLDER_START in text for text in _texts(start))
        or _has_unknown_parameter(start)
    )


def _texts(start: LaunchStart) -> Iterator[str]:
    yield from (start.package, start.program, start.full_name, start.container, *start.arguments)
    for pair in (*start.remaps, *start.environ):
        yield from pair


def _has_unknown_parameter(start: LaunchStart) -> bool:
    return any(
        isinstance(parameter.value, UnknownValue)
        for source in start.parameter_sources
        for _, values in source.entries
        for parameter in values.values()
    )

"""What a substitution or function sees of the launch that a Python launch file defines itself."""

from collections.abc import Callable
from dataclasses import dataclass

from rtron.sources.launch.ros2.launch_context import Scope
from rtron.sources.launch.ros2.parameters.file_cache import YamlFiles
from rtron.sources.launch.ros2.substitutions.template import Written


@dataclass(frozen=True, slots=True, kw_only=True)
class View:
    """A launch at one place: `perform` evaluates texts, `files` are what it reads and makes."""

    perform: Callable[[Written], str]
    scope: Scope
    note: Callable[[str], None]
    files: YamlFiles

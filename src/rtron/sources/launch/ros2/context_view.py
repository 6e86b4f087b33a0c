"""What a substitution or function sees of the launch that a Python launch file defines itself."""

from collections.abc import Callable
from dataclasses import dataclass

from rtron.sources.launch.ros2.launch_context import LaunchContext
from rtron.sources.launch.ros2.parameters.file import YamlFileCache
from rtron.sources.launch.ros2.substitutions.template import TemplateText


@dataclass(frozen=True, slots=True, kw_only=True)
class ContextView:
    """A launch at one place: `perform` evaluates texts, `files` are what it reads and makes."""

    perform: Callable[[TemplateText], str]
    context: LaunchContext
    note: Callable[[str], None]
    files: YamlFileCache

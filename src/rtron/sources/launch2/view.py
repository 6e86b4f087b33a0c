"""What a substitution or function sees of the launch that a Python launch file defines itself."""

from collections.abc import Callable
from dataclasses import dataclass

from rtron.sources.launch2.pieces import Written
from rtron.sources.launch2.scope import Scope
from rtron.sources.launch2.yaml_files import YamlFiles


@dataclass(frozen=True, slots=True, kw_only=True)
class View:
    """A launch at one place: `perform` evaluates texts, `files` are what it reads and makes."""

    perform: Callable[[Written], str]
    scope: Scope
    note: Callable[[str], None]
    files: YamlFiles

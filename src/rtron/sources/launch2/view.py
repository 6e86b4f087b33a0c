"""What a substitution or function sees of the launch that a Python launch file defines itself."""

from collections.abc import Callable
from dataclasses import dataclass

from rtron.sources.launch.yaml_text import YamlTree
from rtron.sources.launch2.pieces import Written
from rtron.sources.launch2.scope import Scope


@dataclass(frozen=True, slots=True, kw_only=True)
class View:
    """A launch at one place: `perform` evaluates a text there, `made` are files made on the way."""

    perform: Callable[[Written], str]
    scope: Scope
    note: Callable[[str], None]
    made: dict[str, YamlTree]

    def make(self, source: str, tree: YamlTree) -> str:
        """Keep a YAML file that exists only while the launch runs; return what it is called."""
        path = f"{source}#{len(self.made) + 1}"
        self.made[path] = tree
        return path

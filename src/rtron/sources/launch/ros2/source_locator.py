"""Files that a build installs in another folder of their package than the one they lie in."""

from dataclasses import dataclass
from pathlib import Path

from rtron.sources.workspace import Workspace


@dataclass(frozen=True, slots=True)
class SourceLocator:
    """Finds the source of a file that is asked for in a package's share folder."""

    workspace: Workspace

    def __call__(self, path: str) -> str:
        """Return a file's source: itself, or the one file of its package with its name."""
        found = self.workspace.installed_source(Path(path))
        return path if found == Path(path) else str(found)

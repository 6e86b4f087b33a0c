"""Files that a build installs in another folder of their package than the one they lie in."""

from dataclasses import dataclass
from pathlib import Path

from rtron.folders import is_there
from rtron.sources.workspace import Workspace


@dataclass(frozen=True, slots=True)
class Installed:
    """Finds the source of a file that is asked for in a package's share folder."""

    workspace: Workspace

    def __call__(self, path: str) -> str:
        """Return a file's source: itself, or the one file of its package with its name."""
        asked = Path(path)
        if is_there(asked):
            return path
        package = self.workspace.package_of(asked)
        found = self.workspace.files(package).called(asked.name) if package else ()
        return str(found[0]) if len(found) == 1 else path

"""In which package a file lies, and where that is without links."""

from dataclasses import dataclass
from pathlib import Path

_MANIFESTS = ("package.xml", "manifest.xml")


@dataclass(frozen=True, slots=True)
class PackageFile:
    """A file of a package: the package's real folder, and the file's path below it."""

    package: Path
    relative_path: Path

    @property
    def path(self) -> Path:
        """The file, with no link on the way to its package."""
        return self.package / self.relative_path


def find_package_file(path: Path) -> PackageFile | None:
    """Return where a file lies in its package; None if it lies in none."""
    for folder in path.parents:
        if any((folder / name).is_file() for name in _MANIFESTS):
            return PackageFile(folder.resolve(), path.relative_to(folder))
    return None

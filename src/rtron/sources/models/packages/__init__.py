"""Launch files and robot descriptions of well-known packages that a workspace often lacks."""

from pathlib import Path

_FOLDER = Path(__file__).parent


def known_packages() -> dict[str, Path]:
    """Return the packages known here; one that is found counts instead (docs/models.md)."""
    folders = (path for path in sorted(_FOLDER.iterdir()) if not path.name.startswith("_"))
    return {folder.name: folder for folder in folders if folder.is_dir()}


def known_package_of(path: str) -> str:
    """Return the name of the package known here that a path lies in, empty for another path."""
    place = Path(path)
    return place.relative_to(_FOLDER).parts[0] if place.is_relative_to(_FOLDER) else ""

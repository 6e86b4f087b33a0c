"""Launch files and robot descriptions of well-known packages that a workspace often lacks."""

from pathlib import Path

_FOLDER = Path(__file__).parent


def known_packages() -> dict[str, Path]:
    """Return the packages known here; one that is found counts instead (docs/models.md)."""
    folders = (path for path in sorted(_FOLDER.iterdir()) if not path.name.startswith("_"))
    return {folder.name: folder for folder in folders if folder.is_dir()}

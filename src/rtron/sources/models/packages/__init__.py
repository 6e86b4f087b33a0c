"""Launch files of well-known packages that are often not in a workspace, as far as nodes go."""

from pathlib import Path

_FOLDER = Path(__file__).parent


def known_packages() -> dict[str, Path]:
    """Return the packages whose launch files are known; a package that is found counts instead."""
    return {folder.name: folder for folder in sorted(_FOLDER.iterdir()) if (folder / "launch").is_dir()}

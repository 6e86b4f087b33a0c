"""What looks like a bag: told without reading it."""

from pathlib import Path

METADATA = "metadata.yaml"
ROOT = "rosbag2_bagfile_information"
SUFFIXES = frozenset({".bag", ".mcap", ".db3"})
_HEAD = 4096


def is_bag(path: Path) -> bool:
    """Tell whether a path is a bag, by its name; a folder, by how its metadata begins."""
    return _is_bag_folder(path) if path.is_dir() else path.suffix in SUFFIXES


def _is_bag_folder(path: Path) -> bool:
    metadata = path / METADATA
    try:
        with metadata.open("rb") as stream:
            return ROOT.encode() in stream.read(_HEAD)
    except OSError:
        return False

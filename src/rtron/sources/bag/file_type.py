"""What looks like a bag: told without reading it."""

from pathlib import Path

from rtron.folders import is_folder

METADATA = "metadata.yaml"
METADATA_KEY = "rosbag2_bagfile_information"
SUFFIXES = frozenset({".bag", ".mcap", ".db3"})
_HEAD_BYTES = 4096


def is_bag(path: Path) -> bool:
    """Tell whether a path is a bag, by its name; a folder, by how its metadata begins.

    Raise InputError for a path that cannot be looked at.
    """
    return _is_bag_folder(path) if is_folder(path) else path.suffix in SUFFIXES


def _is_bag_folder(path: Path) -> bool:
    metadata = path / METADATA
    try:
        with metadata.open("rb") as stream:
            return METADATA_KEY.encode() in stream.read(_HEAD_BYTES)
    except OSError:
        return False
